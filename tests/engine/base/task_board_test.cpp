#include "engine/base/task_board.h"

#include <array>
#include <atomic>
#include <chrono>
#include <stdexcept>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "engine/base/parallel.h"

namespace geosis {
namespace {

bool never() {
  return false;
}

TEST(TaskBoard, WithoutHelpersRunsTheMostUrgentFirstAndEqualsInOrder) {
  TaskBoard board(0);
  std::vector<int> order;
  for (const int urgency : {1, 3, 2, 3}) {
    board.add(urgency, [&order, urgency, number = static_cast<int>(order.size())] { order.push_back(urgency); });
  }
  EXPECT_TRUE(order.empty());
  board.work_until(0, never);
  EXPECT_EQ(order, (std::vector<int>{3, 3, 2, 1}));
}

TEST(TaskBoard, StopsWhenTheGoalIsReachedAndLeavesLessUrgentTasks) {
  TaskBoard board(0);
  int run = 0;
  for (int i = 0; i < 5; ++i) board.add(1, [&] { ++run; });
  board.add(0, [&] { run += 100; });
  board.work_until(0, [&] { return run == 2; });
  EXPECT_EQ(run, 2);
  board.work_until(1, never);
  EXPECT_EQ(run, 5);
}

TEST(TaskBoard, TasksAddTasks) {
  TaskBoard board(1);
  std::atomic<int> run = 0;
  board.add(0, [&] {
    for (int i = 0; i < 10; ++i) board.add(1, [&] { ++run; });
  });
  board.work_until(0, [&] { return run == 10; });
  EXPECT_EQ(run, 10);
}

TEST(TaskBoard, SpareThreadsWorkWhileNobodyWaits) {
  TaskBoard board(1);
  std::atomic<bool> ran = false;
  board.add(0, [&] { ran = true; });
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(30);
  while (!ran && std::chrono::steady_clock::now() < end) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  EXPECT_TRUE(ran);
}

TEST(TaskBoard, NoMoreThanTheHelpersRunAtATime) {
  std::atomic<int> running = 0, most = 0, run = 0;
  TaskBoard board(2);
  for (int i = 0; i < 200; ++i) {
    board.add(0, [&] {
      most = std::max(most.load(), ++running);
      std::this_thread::sleep_for(std::chrono::microseconds(50));
      --running;
      ++run;
    });
  }
  board.work_until(0, [&] { return run == 200; });
  EXPECT_EQ(run, 200);
  EXPECT_LE(most, 3);  // the helpers and this thread
}

TEST(TaskBoard, ManyTasksBesideAParallelForAllRunOnce) {
  constexpr std::size_t kTasks = 500;
  std::array<std::atomic<int>, kTasks> runs = {};
  TaskBoard board(3);
  for (std::size_t i = 0; i < kTasks; ++i) {
    board.add(static_cast<int>(i % 7), [&, i] {
      std::atomic<int> sum = 0;
      parallel_for(4, 2, [&](std::size_t) { ++sum; });
      runs[i] += sum / 4;
    });
  }
  std::atomic<int> sum = 0;
  parallel_for(1000, 4, [&](std::size_t) { ++sum; });
  board.work_until(0, never);
  for (const auto& count : runs) EXPECT_EQ(count, 1);
  EXPECT_EQ(sum, 1000);
}

TEST(TaskBoard, ThrowsWhatATaskHasThrown) {
  for (const int helpers : {0, 1}) {
    TaskBoard board(helpers);
    board.add(0, [] { throw std::length_error("too long"); });
    EXPECT_THROW(board.work_until(0, never), std::length_error);
  }
}

TEST(TaskBoard, ForgetsWhatHasNotBegunAndWaitsForTheRest) {
  for (int round = 0; round < 50; ++round) {
    std::atomic<int> begun = 0, ended = 0;
    {
      TaskBoard board(1);
      for (int i = 0; i < 20; ++i) {
        board.add(0, [&] {
          ++begun;
          std::this_thread::sleep_for(std::chrono::microseconds(100));
          ++ended;
        });
      }
    }
    EXPECT_EQ(begun, ended);
    EXPECT_LT(ended, 20);
  }
}

}  // namespace
}  // namespace geosis
