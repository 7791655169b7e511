#include "engine/simplify/bucket_queue.h"

#include <algorithm>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

namespace geosis {
namespace {

std::vector<int> pop_all(BucketQueue& queue) {
  std::vector<int> order;
  for (QueuedEdge edge; queue.pop(edge);) order.push_back(edge.u);
  return order;
}

TEST(BucketQueue, GivesCheapestFirst) {
  BucketQueue queue;
  const float costs[] = {3, 0.001f, 700, 0, 1e-9f};
  for (std::uint16_t i = 0; i < 5; ++i) queue.push({i, 0, 0, 0}, costs[i]);
  EXPECT_EQ(pop_all(queue), (std::vector<int>{3, 4, 1, 0, 2}));
}

TEST(BucketQueue, IsLastInFirstOutAmongEqualCosts) {
  BucketQueue queue;
  for (std::uint16_t i = 0; i < 4; ++i) queue.push({i, 0, 0, 0}, 1);
  EXPECT_EQ(pop_all(queue), (std::vector<int>{3, 2, 1, 0}));
}

TEST(BucketQueue, TakesCheaperEdgesPushedAfterPops) {
  BucketQueue queue;
  queue.push({1, 0, 0, 0}, 100);
  queue.push({2, 0, 0, 0}, 200);
  QueuedEdge edge;
  ASSERT_TRUE(queue.pop(edge));
  queue.push({3, 0, 0, 0}, 0.5f);
  EXPECT_EQ(pop_all(queue), (std::vector<int>{3, 2}));
}

TEST(BucketQueue, SeparatesCostsFourPercentApart) {
  BucketQueue queue;
  float cost = 1e-6f;
  for (std::uint16_t i = 0; i < 500; ++i, cost *= 1.04f)
    queue.push({static_cast<std::uint16_t>(499 - i), 0, 0, 0}, cost);
  const auto order = pop_all(queue);
  ASSERT_EQ(order.size(), 500u);
  EXPECT_TRUE(std::is_sorted(order.rbegin(), order.rend()));
}

TEST(BucketQueue, TakesCostsOfAnySize) {
  BucketQueue queue;
  queue.push({1, 0, 0, 0}, std::numeric_limits<float>::infinity());
  queue.push({2, 0, 0, 0}, std::numeric_limits<float>::denorm_min());
  EXPECT_EQ(pop_all(queue), (std::vector<int>{2, 1}));
}

TEST(BucketQueue, IsEmptyAfterClear) {
  BucketQueue queue;
  queue.push({1, 0, 0, 0}, 1);
  queue.clear();
  EXPECT_TRUE(pop_all(queue).empty());
}

}  // namespace
}  // namespace geosis
