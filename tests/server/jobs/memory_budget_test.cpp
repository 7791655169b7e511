#include "server/jobs/memory_budget.h"

#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace geosis::server {
namespace {

TEST(MemoryBudget, GivesNoMoreThanThereIs) {
  MemoryBudget budget(100);
  EXPECT_TRUE(budget.can_ever_hold(100));
  EXPECT_FALSE(budget.can_ever_hold(101));
  auto first = budget.reserve(60);
  ASSERT_TRUE(first);
  EXPECT_FALSE(budget.reserve(41));
  const auto second = budget.reserve(40);
  ASSERT_TRUE(second);
  EXPECT_EQ(budget.reserved(), 100U);
  EXPECT_FALSE(budget.reserve(std::uint64_t(0) - 1));
  first.reset();
  EXPECT_EQ(budget.reserved(), 40U);
}

TEST(MemoryBudget, AReservationIsGivenBackOnceHoweverItMoves) {
  MemoryBudget budget(100);
  int rings = 0;
  budget.on_release([&] { ++rings; });
  {
    MemoryBudget::Reservation held;
    held = *budget.reserve(30);
    MemoryBudget::Reservation moved = std::move(held);
    EXPECT_EQ(moved.bytes(), 30U);
    EXPECT_EQ(held.bytes(), 0U);
    EXPECT_EQ(budget.reserved(), 30U);
  }
  EXPECT_EQ(budget.reserved(), 0U);
  EXPECT_EQ(rings, 1);
}

TEST(MemoryBudget, ManyThreadsNeverHoldMoreThanThereIs) {
  MemoryBudget budget(10);
  std::atomic<std::uint64_t> held = 0, most = 0, got = 0;
  const auto work = [&] {
    for (int i = 0; i < 2000; ++i) {
      const auto mine = budget.reserve(static_cast<std::uint64_t>(i % 7));
      if (!mine) continue;
      ++got;
      const std::uint64_t now = held += mine->bytes();
      for (std::uint64_t seen = most; seen < now && !most.compare_exchange_weak(seen, now);) {
      }
      held -= mine->bytes();
    }
  };
  {
    std::vector<std::jthread> threads;
    for (int t = 0; t < 4; ++t) threads.emplace_back(work);
  }
  EXPECT_GT(got, 0U);
  EXPECT_LE(most, 10U);
  EXPECT_EQ(budget.reserved(), 0U);
}

}  // namespace
}  // namespace geosis::server
