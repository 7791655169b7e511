#include "server/jobs/handler_pool.h"

#include <atomic>
#include <chrono>
#include <future>

#include <gtest/gtest.h>

namespace geosis::server {
namespace {

using Lane = HandlerPool::Lane;
using namespace std::chrono_literals;

struct Held {
  std::promise<void> release;
  std::shared_future<void> released = release.get_future().share();
  std::atomic<int> running = 0;

  std::function<void()> work() {
    return [this] {
      ++running;
      released.wait();
    };
  }
};

bool holds_soon(const std::function<bool()>& condition) {
  for (const auto end = std::chrono::steady_clock::now() + 10s; std::chrono::steady_clock::now() < end;) {
    if (condition()) return true;
    std::this_thread::sleep_for(1ms);
  }
  return false;
}

TEST(HandlerPool, WritingLeavesThreadsAndRoomToReading) {
  Held held;
  HandlerPool pool(4, 100);
  for (int i = 0; i < 100; ++i) EXPECT_TRUE(pool.submit(Lane::writing, held.work()));
  EXPECT_TRUE(holds_soon([&] { return held.running == 3; }));
  std::promise<void> was_read;
  EXPECT_TRUE(pool.submit(Lane::reading, [&] { was_read.set_value(); }));
  EXPECT_EQ(was_read.get_future().wait_for(10s), std::future_status::ready);
  EXPECT_EQ(held.running, 3);
  held.release.set_value();
  EXPECT_TRUE(holds_soon([&] { return held.running == 100; }));
}

TEST(HandlerPool, ReadingLeavesAThreadToWriting) {
  Held held;
  HandlerPool pool(4, 100);
  std::promise<void> was_written;
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(pool.submit(Lane::reading, held.work()));
  EXPECT_TRUE(holds_soon([&] { return held.running == 3; }));
  std::promise<void> blocked;
  pool.submit(Lane::reading, [&, released = blocked.get_future().share()] { released.wait(); });
  for (int i = 0; i < 50; ++i) EXPECT_TRUE(pool.submit(Lane::reading, held.work()));
  EXPECT_TRUE(pool.submit(Lane::writing, [&] { was_written.set_value(); }));
  blocked.set_value();  // the thread that is free now has 50 readers and a writer to choose from
  EXPECT_EQ(was_written.get_future().wait_for(10s), std::future_status::ready);
  held.release.set_value();
}

TEST(HandlerPool, RefusesBeyondALanesQueueAndTakesWhatResumes) {
  Held held;
  HandlerPool pool(1, 2);
  EXPECT_TRUE(pool.submit(Lane::reading, held.work()));
  EXPECT_TRUE(holds_soon([&] { return held.running == 1; }));
  EXPECT_TRUE(pool.submit(Lane::writing, held.work()));
  EXPECT_TRUE(pool.submit(Lane::writing, held.work()));
  EXPECT_FALSE(pool.submit(Lane::writing, held.work()));
  EXPECT_TRUE(pool.resume(Lane::writing, held.work()));
  EXPECT_TRUE(pool.submit(Lane::reading, held.work()));
  held.release.set_value();
  EXPECT_TRUE(holds_soon([&] { return held.running == 5; }));
  pool.stop();
  EXPECT_FALSE(pool.resume(Lane::reading, held.work()));
}

}  // namespace
}  // namespace geosis::server
