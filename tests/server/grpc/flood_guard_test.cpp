#include "server/grpc/connections/flood_guard.h"

#include <gtest/gtest.h>

namespace geosis::server::rpc {
namespace {

using Names = std::vector<std::string>;

constexpr FloodGuard::Limits kLimits{.calls = {.of_one = 100, .of_one_then = 10, .of_all = 120},
                                     .bytes = {.of_one = 1000, .of_one_then = 800, .of_all = 5000},
                                     .message_bytes = 50,
                                     .head_bytes = 10,
                                     .unlooked_bytes = 5};

TEST(FloodGuard, EndsConnectionsThatHoldTooManyCalls) {
  FloodGuard guard(kLimits);
  const auto verdict = guard.judge({{"a"}, {"b"}, {"c"}}, 82, {{"a", 100}, {"b", 101}, {"c", 1}});
  EXPECT_EQ(verdict.harmful, Names{"b"});
  EXPECT_FALSE(verdict.is_full);
}

TEST(FloodGuard, IsStricterAndTakesNobodyWhileAllHoldTooManyCallsThatNobodyServes) {
  FloodGuard guard(kLimits);
  const std::vector<ConnectionCounts> counts = {{"a", 100}, {"b", 10}, {"c", 11}};
  const auto verdict = guard.judge({{"a"}, {"b"}, {"c"}}, 0, counts);
  EXPECT_EQ(verdict.harmful, (Names{"a", "c"}));
  EXPECT_TRUE(verdict.is_full);
  EXPECT_TRUE(guard.judge({{"a"}, {"b"}, {"c"}}, 1, counts).harmful.empty());
  EXPECT_FALSE(guard.judge({{"a"}, {"b"}, {"c"}}, 1, counts).is_full);
}

TEST(FloodGuard, RemembersWhatConnectionsHoldThatHaveNotMoved) {
  FloodGuard guard(kLimits);
  EXPECT_FALSE(guard.judge({{"a"}, {"b"}}, 0, {{"a", 60}, {"b", 60}}).is_full);
  EXPECT_TRUE(guard.judge({{"a"}, {"b"}}, 0, {{"b", 61}}).is_full);
  EXPECT_FALSE(guard.judge({{"b"}}, 0, {}).is_full);  // the other one is gone
}

TEST(FloodGuard, CountsWhatItEndedUntilThatIsGone) {
  FloodGuard guard(kLimits);
  guard.judge({{"a", 9000}}, 0, {{"a", 1, 1, 7}});
  EXPECT_EQ(guard.judge({{"a", 14'001}}, 0, {{"a", 1, 1, 7}}).harmful, Names{"a"});
  const auto ended = guard.judge({{"a", 0, true}}, 0, {{"a", 1, 1, 7}});
  EXPECT_TRUE(ended.harmful.empty());
  EXPECT_TRUE(ended.is_full);
  EXPECT_FALSE(guard.judge({{"a", 0, true}}, 0, {}).is_full);
}

TEST(FloodGuard, EndsConnectionsWhoseBytesComeToNothing) {
  FloodGuard guard(kLimits);
  const std::vector<ConnectionCounts> counts = {{"a", 1, 3, 7}, {"b", 2, 3, 7}};
  EXPECT_TRUE(guard.judge({{"a", 9000}, {"b", 9000}}, 3, counts).harmful.empty());
  EXPECT_TRUE(guard.judge({{"a", 10'050}, {"b", 10'051}}, 3, counts).harmful.empty());
  EXPECT_EQ(guard.judge({{"a", 10'051}, {"b", 10'100}}, 3, counts).harmful, Names{"a"});
  // Heads of further calls are something, within their limit.
  EXPECT_TRUE(guard.judge({{"b", 10'110}}, 2, {{"b", 2, 4, 7}}).harmful.empty());
  EXPECT_EQ(guard.judge({{"b", 10'111}}, 2, {{"b", 2, 4, 7}}).harmful, Names{"b"});
  // A message is whole: what was sent until then was for it.
  EXPECT_TRUE(guard.judge({{"b", 20'000}}, 2, {{"b", 2, 4, 8}}).harmful.empty());
  EXPECT_TRUE(guard.judge({{"b", 21'100}}, 2, {{"b", 2, 4, 8}}).harmful.empty());
}

TEST(FloodGuard, IsStricterWhileTheBytesOfAllComeToNothing) {
  FloodGuard guard(kLimits);
  std::vector<FloodGuard::Open> open;
  std::vector<ConnectionCounts> counts;
  for (const char* name : {"a", "b", "c", "d", "e", "f", "g"}) {
    open.push_back({name, 0});
    counts.push_back({name, 1, 1, 1});
  }
  guard.judge(open, 0, counts);
  for (auto& one : open) one.bytes = 700;
  EXPECT_TRUE(guard.judge(open, 0, counts).harmful.empty());
  open[3].bytes = 801 + 7 * 20;
  const auto verdict = guard.judge(open, 0, counts);
  EXPECT_EQ(verdict.harmful, Names{"d"});
  EXPECT_TRUE(verdict.is_full);
}

TEST(FloodGuard, TakesAnAddressThatComesBackForAnother) {
  FloodGuard guard(kLimits);
  guard.judge({{"a", 9000}}, 1, {{"a", 1, 1, 7}});
  EXPECT_TRUE(guard.judge({{"a", 10}}, 1, {{"a", 1, 1, 7}}).harmful.empty());
}

TEST(FloodGuard, HasNothingToSayWithoutServers) {
  const auto verdict = FloodGuard(kLimits).look({{"a", 1 << 30}}, 0);
  EXPECT_TRUE(verdict.harmful.empty());
  EXPECT_FALSE(verdict.is_full);
}

}  // namespace
}  // namespace geosis::server::rpc
