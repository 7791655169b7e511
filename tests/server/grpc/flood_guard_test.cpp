#include "server/grpc/flood_guard.h"

#include <gtest/gtest.h>

namespace geosis::server::rpc {
namespace {

using Names = std::vector<std::string>;

constexpr FloodGuard::Limits kLimits{.of_one = 100, .of_one_then = 10, .of_all = 500};

TEST(FloodGuard, EndsConnectionsThatHoldTooMany) {
  const auto verdict = FloodGuard(kLimits).judge(250, {{"a", 100}, {"b", 101}, {"c", 49}});
  EXPECT_EQ(verdict.harmful, Names{"b"});
  EXPECT_FALSE(verdict.is_full);
}

TEST(FloodGuard, IsStricterAndTakesNobodyWhileAllHoldTooMuch) {
  const auto verdict = FloodGuard(kLimits).judge(501, {{"a", 11}, {"b", 10}, {"c", 0}});
  EXPECT_EQ(verdict.harmful, Names{"a"});
  EXPECT_TRUE(verdict.is_full);
}

TEST(FloodGuard, HasNothingToSayWithoutServers) {
  const auto verdict = FloodGuard(kLimits).look();
  EXPECT_TRUE(verdict.harmful.empty());
  EXPECT_FALSE(verdict.is_full);
}

}  // namespace
}  // namespace geosis::server::rpc
