#include "server/grpc/connections/lent_socket.h"

#include <poll.h>

#include "server/net/listener.h"
#include "tests/server/grpc/sockets.h"

namespace geosis::server::rpc {
namespace {

/// Both ends of a connection.
struct Pair {
  Descriptor client, server;
};

Pair connected(const std::string& address = "127.0.0.1:0") {
  Listener listener = *Listener::open(address);
  Pair pair;
  pair.client = test::connect_to(listener.port());
  while (!pair.server.is_open()) pair.server = std::move(listener.accept().socket);
  return pair;
}

TEST(LentSocket, IsOpenAsLongAsItsNumberNamesIt) {
  Pair pair = connected();
  const LentSocket lent(pair.server.number());
  EXPECT_TRUE(lent.is_open());
  pair.server.close();
  EXPECT_FALSE(lent.is_open());
  Pair other = connected();  // gets the number
  EXPECT_EQ(other.client.number(), lent.number());
  EXPECT_FALSE(lent.is_open());
  lent.reset();
  EXPECT_EQ(::send(other.client.number(), "!", 1, MSG_NOSIGNAL), 1);
}

TEST(LentSocket, AResetLeavesNothingToRead) {
  Pair pair = connected();
  ASSERT_EQ(::send(pair.client.number(), "12345", 5, MSG_NOSIGNAL), 5);
  pollfd event{pair.server.number(), POLLIN, 0};
  ASSERT_EQ(::poll(&event, 1, 5000), 1);
  LentSocket(pair.server.number()).reset();
  char byte = 0;
  EXPECT_LE(::recv(pair.server.number(), &byte, 1, MSG_DONTWAIT), 0);
  EXPECT_LT(::recv(pair.client.number(), &byte, 1, 0), 0);
  EXPECT_EQ(errno, ECONNRESET);
}

TEST(LentSocket, IsNoneByDefault) {
  EXPECT_FALSE(LentSocket().is_open());
  LentSocket().reset();
}

}  // namespace
}  // namespace geosis::server::rpc
