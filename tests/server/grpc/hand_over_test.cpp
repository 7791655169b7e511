#include "server/grpc/connections/hand_over.h"

#include <atomic>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <poll.h>

#include "server/net/listener.h"
#include "tests/server/grpc/sockets.h"

namespace geosis::server::rpc {
namespace {

using namespace std::chrono_literals;

/// Sockets as they are handed over: both ends of connections.
class HandOverTest : public testing::Test {
 protected:
  /// Keeps a lane until its client hangs up, is ended or says something.
  HandOver::Lane lane() {
    return [this](Descriptor socket) {
      ++begun_;
      char byte = 0;
      pollfd event{socket.number(), POLLIN, 0};
      ::poll(&event, 1, -1);
      if (::recv(socket.number(), &byte, 1, 0) == 1) ++heard_;
    };
  }
  Descriptor client_of(HandOver& hand_over) {
    Descriptor client = test::connect_to(listener_.port());
    for (;;) {
      Listener::Accepted accepted = listener_.accept();
      if (accepted.outcome != Listener::Accepted::Outcome::connection) continue;
      hand_over.hand(std::move(accepted.socket), std::to_string(++handed_));
      return client;
    }
  }
  static void say(const Descriptor& client) { EXPECT_EQ(::send(client.number(), "!", 1, MSG_NOSIGNAL), 1); }
  static bool is_ended(const Descriptor& client) {
    char byte = 0;
    return ::recv(client.number(), &byte, 1, 0) <= 0;
  }
  static void wait_until(const std::atomic<int>& count, int least) {
    while (count < least) std::this_thread::sleep_for(1ms);
  }

  Listener listener_ = *Listener::open("127.0.0.1:0");
  std::atomic<int> begun_{0}, heard_{0};
  int handed_ = 0;  // each has its number as its name
};

TEST_F(HandOverTest, OneThatKeepsItsLaneDoesNotKeepOthersWaiting) {
  HandOver hand_over({lane(), lane()}, 1h);
  const Descriptor busy = client_of(hand_over);
  for (int n = 1; n <= 5; ++n) {
    say(client_of(hand_over));
    wait_until(heard_, n);
  }
  say(busy);
  wait_until(heard_, 6);
}

TEST_F(HandOverTest, NamesTheOneThatHasKeptItsLaneLongest) {
  HandOver hand_over({lane(), lane()}, 20ms);
  const Descriptor first = client_of(hand_over);
  wait_until(begun_, 1);
  std::this_thread::sleep_for(5ms);
  const Descriptor second = client_of(hand_over);
  wait_until(begun_, 2);
  std::this_thread::sleep_for(40ms);
  EXPECT_EQ(hand_over.stuck(), std::nullopt);  // nobody waits
  const Descriptor third = client_of(hand_over);
  EXPECT_EQ(hand_over.stuck(), "1");
  EXPECT_EQ(hand_over.stuck(), std::nullopt);  // said
  say(first);
  wait_until(begun_, 3);
  EXPECT_EQ(hand_over.stuck(), std::nullopt);
  say(second);
  say(third);
  wait_until(heard_, 3);
}

TEST_F(HandOverTest, NobodyIsNamedBeforeHisTime) {
  HandOver hand_over({lane()}, 1h);
  const Descriptor first = client_of(hand_over);
  wait_until(begun_, 1);
  const Descriptor second = client_of(hand_over);
  EXPECT_EQ(hand_over.stuck(), std::nullopt);
  say(first);
  say(second);
  wait_until(heard_, 2);
}

TEST_F(HandOverTest, StopsWhoeverKeepsALane) {
  HandOver hand_over({lane(), lane()}, 20ms);
  const Descriptor first = client_of(hand_over), second = client_of(hand_over);
  wait_until(begun_, 2);
  const Descriptor waiting = client_of(hand_over);
  hand_over.stop();
  EXPECT_TRUE(is_ended(first) && is_ended(second) && is_ended(waiting));
  EXPECT_EQ(begun_, 2);
  EXPECT_TRUE(is_ended(client_of(hand_over)));
}

}  // namespace
}  // namespace geosis::server::rpc
