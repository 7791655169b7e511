#include "server/grpc/connections/acceptor.h"

#include <mutex>
#include <vector>

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>

#include "tests/server/grpc/sockets.h"

namespace geosis::server::rpc {
namespace {

using namespace std::chrono_literals;
using test::connect_to;

/// Whether the other side hangs up before it has said anything.
bool is_refused(const Descriptor& socket) {
  char byte = 0;
  return ::recv(socket.number(), &byte, 1, 0) <= 0;
}

/// Whether more was said, or the connection was ended, within a few of the acceptor's looks.
bool has_more(const Descriptor& socket) {
  pollfd event{socket.number(), POLLIN, 0};
  return ::poll(&event, 1, 100) > 0;
}

/// As the other side sees it.
std::string name_of(const Descriptor& socket) {
  sockaddr_in address{};
  socklen_t length = sizeof address;
  EXPECT_EQ(::getsockname(socket.number(), reinterpret_cast<sockaddr*>(&address), &length), 0);
  return "ipv4:127.0.0.1:" + std::to_string(ntohs(address.sin_port));
}

class AcceptorTest : public testing::Test {
 protected:
  /// Keeps what it is handed, and greets it.
  Acceptor make(Acceptor::Limits limits) {
    return {*Listener::open("127.0.0.1:0"),
            limits,
            {[this] { return has_room_.load(); },
             [this](Descriptor socket, const std::string&) {
               EXPECT_EQ(::send(socket.number(), "!", 1, MSG_NOSIGNAL), 1);
               const std::lock_guard lock(mutex_);
               held_.push_back(std::move(socket));
             }},
            [this](const std::vector<FloodGuard::Open>&) {
              const std::lock_guard lock(mutex_);
              return verdict_;
            },
            [this] { ++ticks_; }};
  }
  void tell(FloodGuard::Verdict verdict) {
    const std::lock_guard lock(mutex_);
    verdict_ = std::move(verdict);
  }
  void hang_up() {
    const std::lock_guard lock(mutex_);
    held_.clear();
  }

  std::mutex mutex_;
  std::vector<Descriptor> held_;
  FloodGuard::Verdict verdict_;
  std::atomic<int> ticks_{0};
  std::atomic<bool> has_room_{true};
};

TEST_F(AcceptorTest, TakesSoManyAndRefusesTheRest) {
  Acceptor acceptor = make({.connections = 3, .connections_per_peer = 10});
  std::vector<Descriptor> clients;
  for (int n = 0; n < 5; ++n) {
    clients.push_back(connect_to(acceptor.port()));
    EXPECT_EQ(is_refused(clients.back()), n >= 3) << n;
  }
  EXPECT_EQ(acceptor.connections(), 3u);
  hang_up();
  EXPECT_FALSE(is_refused(connect_to(acceptor.port())));  // those that ended make room
}

TEST_F(AcceptorTest, OnePeerGetsHisShareOnly) {
  Acceptor acceptor = make({.connections = 10, .connections_per_peer = 2});
  const Descriptor first = connect_to(acceptor.port()), second = connect_to(acceptor.port());
  EXPECT_FALSE(is_refused(first) || is_refused(second));
  EXPECT_TRUE(is_refused(connect_to(acceptor.port())));
}

TEST_F(AcceptorTest, EndsWhatItIsToldToAndNobodyElse) {
  Acceptor acceptor = make({.connections = 3, .connections_per_peer = 3});
  const Descriptor harmful = connect_to(acceptor.port()), other = connect_to(acceptor.port());
  EXPECT_FALSE(is_refused(harmful) || is_refused(other));  // both are greeted
  tell({.harmful = {name_of(harmful)}, .is_full = false});
  EXPECT_TRUE(is_refused(harmful));
  tell({});
  EXPECT_FALSE(has_more(other));
}

TEST_F(AcceptorTest, APeerWhoseConnectionIsBeingEndedWaitsForThat) {
  Acceptor acceptor = make({.connections = 3, .connections_per_peer = 3, .longest_wait = 1h});
  const Descriptor harmful = connect_to(acceptor.port());
  EXPECT_FALSE(is_refused(harmful));
  tell({.harmful = {name_of(harmful)}, .is_full = false});
  EXPECT_TRUE(is_refused(harmful));
  tell({});
  const Descriptor next = connect_to(acceptor.port());
  EXPECT_FALSE(has_more(next));
  hang_up();
  EXPECT_FALSE(is_refused(next));
}

TEST_F(AcceptorTest, NobodyWaitsForEverForWhatIsBeingEnded) {
  Acceptor acceptor = make({.connections = 3, .connections_per_peer = 3, .longest_wait = 50ms});
  const Descriptor harmful = connect_to(acceptor.port());
  EXPECT_FALSE(is_refused(harmful));
  tell({.harmful = {name_of(harmful)}, .is_full = false});
  EXPECT_TRUE(is_refused(harmful));
  EXPECT_FALSE(is_refused(connect_to(acceptor.port())));
}

TEST_F(AcceptorTest, LetsOthersWaitWhileItIsFull) {
  Acceptor acceptor = make({.connections = 3, .connections_per_peer = 3});
  const Descriptor first = connect_to(acceptor.port());
  EXPECT_FALSE(is_refused(first));
  tell({.harmful = {}, .is_full = true});
  while (!acceptor.may_be_full()) std::this_thread::sleep_for(5ms);
  const Descriptor second = connect_to(acceptor.port());
  hang_up();  // nobody is left whom it would have to look after
  EXPECT_FALSE(has_more(second));
  tell({});
  EXPECT_FALSE(is_refused(second));
}

TEST_F(AcceptorTest, LetsOthersWaitWithTheSystemWhileTheyWouldNotBeTaken) {
  Acceptor acceptor = make({.connections = 2, .connections_per_peer = 2});
  has_room_ = false;
  std::vector<Descriptor> clients;
  for (int n = 0; n < 6; ++n) clients.push_back(connect_to(acceptor.port()));
  EXPECT_FALSE(has_more(clients[0]));
  EXPECT_EQ(acceptor.connections(), 0u);  // none of them is refused either
  has_room_ = true;
  EXPECT_FALSE(is_refused(clients[0]) || is_refused(clients[1]));
}

TEST_F(AcceptorTest, TicksAndStops) {
  Acceptor acceptor = make({.connections = 3, .connections_per_peer = 3});
  const std::uint16_t port = acceptor.port();
  while (ticks_ < 2) std::this_thread::sleep_for(5ms);
  acceptor.stop();
  acceptor.stop();
  EXPECT_TRUE(Listener::open("127.0.0.1:" + std::to_string(port)));  // its port is free
}

}  // namespace
}  // namespace geosis::server::rpc
