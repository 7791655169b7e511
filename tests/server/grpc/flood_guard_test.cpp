#include "server/grpc/connections/flood_guard.h"

#include <algorithm>
#include <list>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace geosis::server::rpc {
namespace {

using Names = std::vector<std::string>;

constexpr FloodGuard::Limits kLimits{.open_calls = 10,
                                     .leftover_calls = {.of_one = 100, .of_all = 120},
                                     .loose_bytes = {.of_one = 2'000'000, .of_all = 4'000'000},
                                     .message_bytes = 1'000'000,
                                     .most_messages = 4,
                                     .head_bytes = 1000,
                                     .unlooked_bytes = 500,
                                     .patience = 3};

/// Connections as the guard meets them, and what gRPC counts of them.
class FloodGuardTest : public testing::Test {
 protected:
  struct Connection {
    FloodGuard::Open open;
    ConnectionCounts counts;
    bool is_gone = false;  ///< gRPC has let go of it
  };
  Connection& add(const std::string& name) {
    connections_.push_back({{.name = name, .id = ++ids_, .bytes = 0}, {.connection = name}});
    return connections_.back();
  }
  /// Sends so many bytes, as a part of a message.
  static void send(Connection& one, std::uint64_t bytes) { one.open.bytes += bytes; }
  static void begin(Connection& one, std::uint64_t calls = 1) {
    one.counts.begun += calls;
    one.counts.held += calls;
  }
  static void end(Connection& one, std::uint64_t calls = 1) { one.counts.held -= calls; }
  static void finish_message(Connection& one) { ++one.counts.messages; }
  FloodGuard::Verdict look(std::uint64_t served = 0) {
    std::vector<FloodGuard::Open> open;
    for (const Connection& one : connections_) open.push_back(one.open);
    return guard_.look(open, served);
  }
  Names harmful(std::uint64_t served = 0) { return look(served).harmful; }

  std::list<Connection> connections_;
  std::uint64_t ids_ = 0, counted_ = 0;
  FloodGuard guard_{kLimits, [this](const auto& is_wanted) {
                      std::vector<ConnectionCounts> counts;
                      for (const Connection& one : connections_) {
                        if (!one.is_gone && is_wanted(one.open.name)) counts.push_back(one.counts);
                      }
                      counted_ += counts.size();
                      return counts;
                    }};
};

TEST_F(FloodGuardTest, EndsWhoHoldsMoreCallsThanMayBeOpenAndSomeOnTheirWayOut) {
  Connection &a = add("a"), &b = add("b");
  begin(a, 110);
  begin(b, 111);
  send(a, 501);
  send(b, 501);
  // Together they have more than 120: then nobody may have more than his half.
  EXPECT_EQ(harmful(), (Names{"a", "b"}));
  end(a, 51);
  EXPECT_EQ(harmful(), (Names{"b"}));
  end(b, 1);
  EXPECT_EQ(harmful(), (Names{"b"}));
  end(b, 41);
  EXPECT_TRUE(harmful().empty());
}

TEST_F(FloodGuardTest, ManyWithAllTheirCallsOpenAreWelcome) {
  for (int n = 0; n < 100; ++n) {
    Connection& one = add(std::to_string(n));
    begin(one, 10);
    send(one, 600);
  }
  const auto verdict = look();
  EXPECT_TRUE(verdict.harmful.empty());
  EXPECT_FALSE(verdict.is_full);
}

TEST_F(FloodGuardTest, LooksOnlyAtConnectionsThatHaveSentSomething) {
  Connection& a = add("a");
  add("b");
  begin(a);
  send(a, 500);
  look();
  EXPECT_EQ(counted_, 0u);
  send(a, 1);
  look();
  look();
  EXPECT_EQ(counted_, 1u);
}

TEST_F(FloodGuardTest, EndsWhoseBytesComeToNothing) {
  Connection& a = add("a");
  begin(a);
  send(a, 3'001'000);  // its head, a message and what anybody may send
  EXPECT_TRUE(harmful().empty());
  send(a, 501);
  EXPECT_EQ(harmful(), Names{"a"});
  finish_message(a);
  send(a, 501);
  EXPECT_TRUE(harmful().empty());
}

TEST_F(FloodGuardTest, TakesACallBackInTheMiddleOfAMessage) {
  Connection& a = add("a");
  for (int n = 0; n < 50; ++n) {
    begin(a, 3);
    send(a, 3'000'000);
    EXPECT_TRUE(harmful(3).empty());
    end(a, 3);
    send(a, 600);
    EXPECT_TRUE(harmful().empty()) << n;
  }
}

TEST_F(FloodGuardTest, SumsUpWhatAllHaveSent) {
  Connection &a = add("a"), &b = add("b");
  begin(a, 2);
  begin(b, 2);
  send(a, 3'000'000);
  send(b, 1'200'000);
  EXPECT_TRUE(harmful(4).empty());  // four calls are served: each may have a message under way
  const auto verdict = look(0);
  EXPECT_EQ(verdict.harmful, Names{"a"});
  EXPECT_TRUE(verdict.is_full);
}

TEST_F(FloodGuardTest, CountsWhatWasEndedUntilThatIsGone) {
  Connection &a = add("a"), &b = add("b");
  begin(a, 2);
  begin(b, 2);
  send(a, 3'000'000);
  send(b, 1'200'000);
  ASSERT_EQ(harmful(), Names{"a"});
  a.open.was_ended = true;
  a.open.bytes = 0;
  EXPECT_TRUE(look().is_full);
  EXPECT_TRUE(harmful().empty());
  a.is_gone = true;
  EXPECT_FALSE(look().is_full);
}

TEST_F(FloodGuardTest, IsNotShutByWhatWasOverBeforeItLookedAgain) {
  for (int n = 0; n < 8; ++n) {
    Connection& one = add(std::to_string(n));
    begin(one);
    send(one, 900'000);
  }
  EXPECT_FALSE(look(8).is_full);  // a message for each of four calls may be under way
  for (Connection& one : connections_) {
    finish_message(one);
    send(one, 400);  // too little for a look
    end(one);
  }
  const auto verdict = look(0);
  EXPECT_FALSE(verdict.is_full);
  EXPECT_TRUE(verdict.harmful.empty());
}

TEST_F(FloodGuardTest, EndsWhatLiesStillWhileAllHaveTooMuch) {
  for (int n = 0; n < 10; ++n) {
    Connection& one = add(std::to_string(n));
    begin(one);
    send(one, 900'000);
  }
  // Nobody has more than his share: the door stays open until it shows who has stopped.
  for (std::uint64_t n = 0; n <= kLimits.patience; ++n) {
    for (int mover = 0; mover < 3; ++mover) send(*std::next(connections_.begin(), mover), 600);
    const auto verdict = look();
    EXPECT_TRUE(verdict.harmful.empty());
    EXPECT_FALSE(verdict.is_full);
  }
  send(connections_.front(), 600);
  const auto verdict = look();
  EXPECT_EQ(verdict.harmful.size(), 7u);
  EXPECT_EQ(std::count(verdict.harmful.begin(), verdict.harmful.end(), "0"), 0);
  EXPECT_TRUE(verdict.is_full);
}

TEST_F(FloodGuardTest, TakesAnAddressThatComesBackForAnother) {
  Connection& a = add("a");
  begin(a);
  send(a, 3'001'000);
  look();
  connections_.clear();
  Connection& again = add("a");
  begin(again);
  send(again, 2'000'000);
  EXPECT_TRUE(harmful().empty());
}

TEST(FloodGuard, HasNothingToSayWithoutServers) {
  const auto verdict = FloodGuard(kLimits).look({{.name = "a", .id = 1, .bytes = 1 << 30}}, 0);
  EXPECT_TRUE(verdict.harmful.empty());
  EXPECT_FALSE(verdict.is_full);
}

}  // namespace
}  // namespace geosis::server::rpc
