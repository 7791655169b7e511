#include "server/grpc/connections/connection_counts.h"

#include <algorithm>
#include <array>
#include <string>
#include <string_view>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include "server/net/descriptor.h"
#include "server/net/listener.h"
#include "tests/server/grpc/door_fixture.h"
#include "tests/server/grpc/sockets.h"

namespace geosis::server::rpc {
namespace {

using namespace std::chrono_literals;
using test::connect_to;

std::uint16_t port_of(const Descriptor& socket) {
  sockaddr_in6 address{};
  socklen_t length = sizeof address;
  EXPECT_EQ(::getsockname(socket.number(), reinterpret_cast<sockaddr*>(&address), &length), 0);
  return ntohs(address.sin6_port);
}

Listener::Accepted accept_one(Listener& listener) {
  for (;;) {
    Listener::Accepted accepted = listener.accept();
    if (accepted.outcome == Listener::Accepted::Outcome::connection) return accepted;
  }
}

TEST(ConnectionName, IsWrittenAsGrpcWritesIt) {
  for (const char* address : {"127.0.0.1:0", "[::]:0"}) {  // the second sees the client's address as a mapped one
    auto listener = Listener::open(address);
    if (!listener) GTEST_SKIP() << "no IPv6 here";
    const Descriptor client = connect_to(listener->port());
    EXPECT_EQ(connection_name(accept_one(*listener).socket.number()),
              "ipv4:127.0.0.1:" + std::to_string(port_of(client)));
  }
  auto listener = Listener::open("[::1]:0");
  if (!listener) GTEST_SKIP() << "no IPv6 here";
  const Descriptor client(::socket(AF_INET6, SOCK_STREAM | SOCK_CLOEXEC, 0));
  sockaddr_in6 address{};
  address.sin6_family = AF_INET6;
  address.sin6_port = htons(listener->port());
  address.sin6_addr = in6addr_loopback;
  ASSERT_EQ(::connect(client.number(), reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
  EXPECT_EQ(connection_name(accept_one(*listener).socket.number()),
            "ipv6:%5B::1%5D:" + std::to_string(port_of(client)));
  EXPECT_EQ(connection_name(-1), "");
}

std::string frame(char kind, char flags, std::uint32_t stream, std::string_view payload) {
  const auto byte = [](std::size_t value) { return static_cast<char>(value & 0xff); };
  std::string text = {0, byte(payload.size() >> 8), byte(payload.size()), kind, flags};
  for (const int shift : {24, 16, 8, 0}) text += byte(stream >> shift);
  return text.append(payload);
}

std::string greeting() {
  return "PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n" + frame(4, 0, 0, "");
}

/// The heads of calls of GetVolume, each taken back at once.
std::string taken_back(std::uint32_t first_stream, std::uint32_t count) {
  std::string head;
  for (const auto& [name, value] : std::initializer_list<std::pair<std::string_view, std::string_view>>{
           {":method", "POST"},
           {":scheme", "http"},
           {":path", "/geosis.v1.VolumeService/GetVolume"},
           {":authority", "a"},
           {"te", "trailers"},
           {"content-type", "application/grpc"}}) {
    head.append({0, static_cast<char>(name.size())})
        .append(name)
        .append({static_cast<char>(value.size())})
        .append(value);
  }
  std::string text;
  for (std::uint32_t n = 0; n < count; ++n) {
    const std::uint32_t stream = first_stream + 2 * n;
    text += frame(1, 4, stream, head) + frame(3, 0, stream, std::string_view("\0\0\0\10", 4));
  }
  return text;
}

bool send_all(const Descriptor& socket, std::string_view text) {
  while (!text.empty()) {
    const ssize_t sent = ::send(socket.number(), text.data(), text.size(), MSG_NOSIGNAL);
    if (sent <= 0) return false;
    text.remove_prefix(static_cast<std::size_t>(sent));
  }
  return true;
}

TEST(BytesRead, LeavesOutWhatIsStillToBeRead) {
  auto listener = Listener::open("127.0.0.1:0");
  const Descriptor client = connect_to(listener->port());
  const auto accepted = accept_one(*listener);
  ASSERT_TRUE(send_all(client, "12345"));
  char bytes[3];
  EXPECT_TRUE(test::comes_true([&] { return ::recv(accepted.socket.number(), bytes, sizeof bytes, MSG_PEEK) == 3; }));
  EXPECT_EQ(bytes_read(accepted.socket.number()), 0u);
  EXPECT_EQ(::recv(accepted.socket.number(), bytes, sizeof bytes, 0), 3);
  EXPECT_EQ(bytes_read(accepted.socket.number()), 3u);
  EXPECT_EQ(bytes_read(-1), 0u);
}

/// How many hold so many calls.
std::ptrdiff_t connections_that_hold(std::uint64_t calls) {
  const auto all = count_connections([](const std::string&) { return true; });
  return std::count_if(all.begin(), all.end(), [&](const ConnectionCounts& one) { return one.held == calls; });
}

class ConnectionCountsTest : public test::DoorTest {
 protected:
  /// Over the connection of before.
  void expect_served(const std::string& volume) const {
    grpc::ClientContext context;
    v1::GetVolumeRequest request;
    request.set_id(volume);
    v1::Volume shown;
    EXPECT_TRUE(volumes->GetVolume(&context, request, &shown).ok());
  }
};

TEST_F(ConnectionCountsTest, CountsTheCallsOfEachConnectionUntilTheyAreOver) {
  start({}, test::gated_after(4, gate_of_work));
  v1::StreamLodsRequest request;
  request.set_id(create(upload_ball()).id());
  grpc::ClientContext context;
  const auto stream = extractions->StreamLods(&context, request);
  v1::LodChunk chunk;
  ASSERT_TRUE(stream->Read(&chunk));
  EXPECT_TRUE(test::comes_true([] { return connections_that_hold(1) == 1; }));
  EXPECT_TRUE(count_connections([](const std::string&) { return false; }).empty());
  gate_of_work.open();
  while (stream->Read(&chunk)) {
  }
  EXPECT_TRUE(stream->Finish().ok());
  EXPECT_TRUE(test::comes_true([] { return connections_that_hold(1) == 0; }));
}

TEST_F(ConnectionCountsTest, AClientWhoTakesBackWhatItBeginsIsHungUpOn) {
  start({.streams_per_connection = 1});  // sixteen may be on their way out
  const std::string other = upload_ball();
  const Descriptor flood = connect_to(door->port());
  ASSERT_TRUE(send_all(flood, greeting()));
  std::uint32_t stream = 1;
  constexpr std::uint32_t kAtOnce = 5000, kEnough = 4'000'000;
  while (stream < kEnough && send_all(flood, taken_back(stream, kAtOnce))) stream += 2 * kAtOnce;
  EXPECT_LT(stream, kEnough);
  expect_served(other);
}

}  // namespace
}  // namespace geosis::server::rpc
