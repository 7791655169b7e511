// Which job of a queue runs when: dues, lanes, memory, deadlines, tenants.
#include <atomic>
#include <chrono>
#include <future>
#include <mutex>
#include <string>
#include <thread>

#include <gtest/gtest.h>

#include "server/jobs/job_queue.h"

namespace geosis::server {
namespace {

using namespace std::chrono_literals;

constexpr auto kLong = 20s;

/// A queue whose workers are held until open() is called, and a record of who ran in which order.
class Scene {
 public:
  explicit Scene(JobQueueOptions options) : queue(options) {}
  ~Scene() { open(); }

  /// Runs until open().
  std::shared_ptr<Job> hold(JobDemand demand) {
    auto job = queue.submit(std::move(demand), [gate = opened_](Job&) -> Result<void> {
      gate.wait();
      return {};
    });
    return *std::move(job);
  }
  std::shared_ptr<Job> note(const std::string& name, JobDemand demand) {
    auto job = queue.submit(std::move(demand), [this, name](Job&) -> Result<void> {
      const std::lock_guard lock(mutex_);
      order_ += name;
      return {};
    });
    return *std::move(job);
  }
  void open() {
    if (!std::exchange(is_open_, true)) gate_.set_value();
  }
  std::string order() {
    queue.drain(kLong);
    const std::lock_guard lock(mutex_);
    return order_;
  }

 private:
  std::promise<void> gate_;
  std::shared_future<void> opened_ = gate_.get_future().share();
  bool is_open_ = false;
  std::mutex mutex_;
  std::string order_;

 public:
  JobQueue queue;  // last: its work uses what is above
};

void wait_until_running(const Job& job) {
  while (job.status().state == JobState::queued) std::this_thread::sleep_for(1ms);
}

TEST(JobOrder, HigherPrioritiesGoFirstThenArrival) {
  Scene scene({.workers = 1, .capacity = 20});
  wait_until_running(*scene.hold({Priority::batch}));
  scene.note("b", {Priority::batch});
  scene.note("i", {Priority::interactive});
  scene.note("p", {Priority::preview});
  scene.note("B", {Priority::batch});
  scene.note("I", {Priority::interactive});
  scene.note("P", {Priority::preview});
  scene.open();
  EXPECT_EQ(scene.order(), "pPiIbB");
}

TEST(JobOrder, WhoHasWaitedLongEnoughGoesBeforeHigherPriorities) {
  Scene scene({.workers = 1, .capacity = 20, .patience = {0ms, 20ms, 60ms}});
  wait_until_running(*scene.hold({Priority::preview}));
  scene.note("b", {Priority::batch});
  std::this_thread::sleep_for(100ms);
  scene.note("p", {Priority::preview});
  scene.note("i", {Priority::interactive});
  scene.open();
  EXPECT_EQ(scene.order(), "bpi");
}

TEST(JobOrder, AFloodOfInteractiveJobsDoesNotStarveBatch) {
  JobQueue queue({.workers = 1, .capacity = 50, .patience = {0ms, 5ms, 50ms}});
  std::atomic<bool> is_done = false;
  const auto nap = [](Job&) -> Result<void> {
    std::this_thread::sleep_for(2ms);
    return {};
  };
  for (int i = 0; i < 20; ++i) ASSERT_TRUE(queue.submit({Priority::interactive}, nap));
  const auto batch = queue.submit({Priority::batch}, [&](Job&) -> Result<void> {
    is_done = true;
    return {};
  });
  ASSERT_TRUE(batch);
  const auto end = std::chrono::steady_clock::now() + kLong;
  while (!is_done && std::chrono::steady_clock::now() < end) {  // faster than one worker can follow
    if (queue.depth() < 40) {
      ASSERT_TRUE(queue.submit({Priority::interactive}, nap));
    }
  }
  EXPECT_TRUE(is_done);
  EXPECT_GT(queue.depth(), 0U);  // the flood was still on
}

TEST(JobOrder, PreviewsHaveAWorkerOfTheirOwn) {
  Scene scene({.workers = 1, .preview_workers = 1, .capacity = 20});
  wait_until_running(*scene.hold({Priority::interactive}));
  const auto interactive = scene.note("i", {Priority::interactive});
  const auto preview = scene.note("p", {Priority::preview});
  EXPECT_TRUE(preview->wait_for(kLong));
  EXPECT_EQ(interactive->status().state, JobState::queued);
}

TEST(JobOrder, BatchLeavesAWorkerToOthers) {
  Scene scene({.workers = 2, .most_batch = 1, .capacity = 20});
  wait_until_running(*scene.hold({Priority::batch}));
  const auto batch = scene.note("b", {Priority::batch});
  const auto interactive = scene.note("i", {Priority::interactive});
  EXPECT_TRUE(interactive->wait_for(kLong));
  EXPECT_EQ(batch->status().state, JobState::queued);
  scene.open();
  EXPECT_EQ(scene.order(), "ib");
}

TEST(JobOrder, WhatFitsLaterWaitsAndLetsOthersGoFirst) {
  MemoryBudget budget(100);
  Scene scene({.workers = 2, .capacity = 20, .budget = &budget});
  wait_until_running(*scene.hold({.memory_bytes = 60}));
  const auto big = scene.note("B", {.memory_bytes = 50});
  const auto small = scene.note("s", {.memory_bytes = 40});
  EXPECT_TRUE(small->wait_for(kLong));
  EXPECT_EQ(big->status().state, JobState::queued);
  scene.open();
  EXPECT_EQ(scene.order(), "sB");
  EXPECT_EQ(budget.reserved(), 0U);
}

TEST(JobOrder, WhatHasWaitedForMemoryTooLongIsNotOvertakenAnyMore) {
  MemoryBudget budget(100);
  Scene scene({.workers = 2, .capacity = 20, .budget = &budget, .memory_patience = 20ms});
  wait_until_running(*scene.hold({.memory_bytes = 60}));
  scene.note("B", {.memory_bytes = 90});
  std::this_thread::sleep_for(60ms);
  const auto small = scene.note("s", {.memory_bytes = 20});
  EXPECT_FALSE(small->wait_for(50ms));
  scene.open();
  EXPECT_TRUE(small->wait_for(kLong));
  EXPECT_EQ(scene.order(), "Bs");
}

TEST(JobOrder, AReservationGivenBackElsewhereWakesTheQueue) {
  MemoryBudget budget(100);
  Scene scene({.workers = 1, .capacity = 20, .budget = &budget});
  auto upload = budget.reserve(80);
  const auto job = scene.note("j", {.memory_bytes = 50});
  EXPECT_FALSE(job->wait_for(30ms));
  upload.reset();
  EXPECT_TRUE(job->wait_for(kLong));
}

TEST(JobOrder, WhatNeverFitsIsRefusedAtOnce) {
  MemoryBudget budget(100);
  JobQueue queue({.capacity = 20, .budget = &budget});
  const auto refused = queue.submit({.memory_bytes = 101}, [](Job&) -> Result<void> { return {}; });
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::limit_exceeded);
  EXPECT_NE(refused.error().message.find("101"), std::string::npos);
}

TEST(JobOrder, OneTenantCannotTakeAllPlaces) {
  Scene scene({.workers = 1, .capacity = 4, .tenant_capacity = 2});
  wait_until_running(*scene.hold({.tenant = "loud"}));
  for (int i = 0; i < 2; ++i) scene.note("l", {.tenant = "loud"});
  const auto nothing = [](Job&) -> Result<void> { return {}; };
  const auto refused = scene.queue.submit({.tenant = "loud"}, nothing);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::quota_exceeded);
  EXPECT_TRUE(scene.queue.submit({.tenant = "quiet"}, nothing));
  scene.open();
}

TEST(JobOrder, AJobThatIsLateFails) {
  JobQueue queue(1, 10);
  const auto soon = std::chrono::steady_clock::now() + 30ms;
  const auto job = *queue.submit({.deadline = soon}, [](Job& self) -> Result<void> {
    while (!self.cancelled()) std::this_thread::sleep_for(1ms);
    return Error{ErrorCode::cancelled, "stopped"};
  });
  std::atomic<bool> has_run = false;
  const auto never = *queue.submit({.deadline = soon}, [&](Job&) -> Result<void> {
    has_run = true;
    return {};
  });
  for (const auto& late : {job, never}) {
    ASSERT_TRUE(late->wait_for(kLong));
    EXPECT_EQ(late->status().state, JobState::failed);
    EXPECT_EQ(late->status().error->code, ErrorCode::deadline_exceeded);
  }
  EXPECT_FALSE(has_run);
}

TEST(JobOrder, NoJobRunsLongerThanAnyMay) {
  JobQueue queue({.capacity = 10, .longest = 30ms});
  const auto job = *queue.submit(JobDemand{}, [](Job& self) -> Result<void> {
    while (!self.cancelled()) std::this_thread::sleep_for(1ms);
    return Error{ErrorCode::cancelled, "stopped"};
  });
  ASSERT_TRUE(job->wait_for(kLong));
  EXPECT_EQ(job->status().error->code, ErrorCode::deadline_exceeded);
}

TEST(JobOrder, ReportsWhatWaitsRunsAndHasEnded) {
  Scene scene({.workers = 1, .capacity = 20});
  const auto held = scene.hold({Priority::interactive});
  wait_until_running(*held);
  const auto cancelled = scene.note("b", {Priority::batch});
  std::this_thread::sleep_for(20ms);
  JobQueueReport report = scene.queue.report();
  EXPECT_EQ(report.rows[1].running, 1U);
  EXPECT_EQ(report.rows[2].waiting, 1U);
  EXPECT_GE(report.longest_silence, 10ms);  // it never asks whether to go on
  cancelled->request_cancel();
  scene.open();
  scene.queue.drain(kLong);
  report = scene.queue.report();
  EXPECT_EQ(report.rows[1].done, 1U);
  EXPECT_EQ(report.rows[2].cancelled, 1U);
  EXPECT_TRUE(report.is_draining);
  EXPECT_EQ(report.longest_silence, 0ms);
}

}  // namespace
}  // namespace geosis::server
