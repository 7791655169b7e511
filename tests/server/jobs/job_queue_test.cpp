#include "server/jobs/job_queue.h"

#include <atomic>
#include <chrono>
#include <future>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace geosis::server {
namespace {

using namespace std::chrono_literals;

constexpr auto kLong = 20s;

Result<void> run_until_cancelled(Job& job) {
  while (!job.cancelled()) std::this_thread::sleep_for(1ms);
  return Error{ErrorCode::cancelled, "cancelled"};
}

void wait_until_running(const Job& job) {
  while (job.status().state == JobState::queued) std::this_thread::sleep_for(1ms);
}

// One worker that is busy until free() is called.
struct BusyQueue {
  explicit BusyQueue(std::size_t capacity) : queue(1, capacity) {
    blocker = queue
                  .submit(Priority::batch,
                          [gate = gate.get_future().share()](Job&) -> Result<void> {
                            gate.wait();
                            return {};
                          })
                  .value();
    wait_until_running(*blocker);
  }
  ~BusyQueue() { free(); }
  void free() {
    if (!is_free) gate.set_value();
    is_free = true;
  }

  std::promise<void> gate;
  bool is_free = false;
  std::shared_ptr<Job> blocker;
  JobQueue queue;
};

TEST(JobQueue, RunsWhatIsSubmitted) {
  JobQueue queue(2, 10);
  const auto job = queue.submit(Priority::interactive, [](Job& self) -> Result<void> {
    self.report("work", 0.5);
    return {};
  });
  ASSERT_TRUE((*job)->wait_for(kLong));
  EXPECT_EQ((*job)->status().state, JobState::done);
  EXPECT_EQ((*job)->status().stage, "work");
}

TEST(JobQueue, ExpectsAWaitAsLongAsItsJobsTake) {
  JobQueue queue(2, 10);
  EXPECT_EQ(queue.expected_wait().count(), 0);
  const auto nap = [](Job&) -> Result<void> {
    std::this_thread::sleep_for(100ms);
    return {};
  };
  ASSERT_TRUE(queue.submit(Priority::batch, nap).value()->wait_for(kLong));
  EXPECT_EQ(queue.expected_wait().count(), 0);  // nothing waits
  for (int i = 0; i < 2; ++i) wait_until_running(*queue.submit(Priority::batch, run_until_cancelled).value());
  std::vector<std::shared_ptr<Job>> waiting;
  for (int i = 0; i < 6; ++i) waiting.push_back(queue.submit(Priority::batch, nap).value());
  EXPECT_GE(queue.expected_wait().count(), 0.3);  // 6 jobs of 100 ms for 2 workers
  EXPECT_LT(queue.expected_wait().count(), 60);
  queue.stop();
  EXPECT_EQ(queue.expected_wait().count(), 0);
}

TEST(JobQueue, RunsAsManyJobsAtATimeAsItHasWorkers) {
  JobQueue queue(3, 10);
  std::atomic<int> inside = 0;
  const auto meet = [&](Job& job) -> Result<void> {
    ++inside;
    while (inside < 3 && !job.cancelled()) std::this_thread::sleep_for(1ms);
    return {};
  };
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(queue.submit(Priority::batch, meet));
  queue.drain(kLong);
  EXPECT_EQ(inside, 3);
}

TEST(JobQueue, AnExceptionFailsItsJobOnly) {
  JobQueue queue(1, 10);
  const auto bad =
      queue.submit(Priority::batch, [](Job&) -> Result<void> { throw std::runtime_error("oops"); }).value();
  const auto odd = queue.submit(Priority::batch, [](Job&) -> Result<void> { throw 7; }).value();
  const auto good = queue.submit(Priority::batch, [](Job&) -> Result<void> { return {}; }).value();
  ASSERT_TRUE(good->wait_for(kLong));
  EXPECT_EQ(good->status().state, JobState::done);
  for (const auto& job : {bad, odd}) {
    EXPECT_EQ(job->status().state, JobState::failed);
    EXPECT_EQ(job->status().error->code, ErrorCode::internal);
  }
  EXPECT_NE(bad->status().error->message.find("oops"), std::string::npos);
}

TEST(JobQueue, RunningWorkSeesItsCancellation) {
  JobQueue queue(1, 10);
  const auto job = queue.submit(Priority::batch, run_until_cancelled).value();
  wait_until_running(*job);
  job->request_cancel();
  ASSERT_TRUE(job->wait_for(kLong));
  EXPECT_EQ(job->status().state, JobState::cancelled);
}

TEST(JobQueue, AJobCancelledWhileQueuedNeverRuns) {
  BusyQueue busy(10);
  std::atomic<bool> has_run = false;
  const auto job = busy.queue
                       .submit(Priority::preview,
                               [&](Job&) -> Result<void> {
                                 has_run = true;
                                 return {};
                               })
                       .value();
  job->request_cancel();
  EXPECT_EQ(job->status().state, JobState::cancelled);
  busy.free();
  busy.queue.drain(kLong);
  EXPECT_FALSE(has_run);
  EXPECT_EQ(busy.blocker->status().state, JobState::done);
}

TEST(JobQueue, AFullQueueIsUnavailable) {
  BusyQueue busy(2);
  const auto nothing = [](Job&) -> Result<void> { return {}; };
  const auto first = busy.queue.submit(Priority::batch, nothing).value();
  ASSERT_TRUE(busy.queue.submit(Priority::preview, nothing));
  EXPECT_EQ(busy.queue.depth(), 2u);
  EXPECT_EQ(busy.queue.submit(Priority::preview, nothing).error().code, ErrorCode::unavailable);
  first->request_cancel();
  EXPECT_TRUE(busy.queue.submit(Priority::batch, nothing));  // takes the place of the cancelled one
  EXPECT_EQ(busy.queue.submit(Priority::batch, nothing).error().code, ErrorCode::unavailable);
}

TEST(JobQueue, TakesHigherPriorityFirstThenOrderOfArrival) {
  BusyQueue busy(10);
  std::string order;
  const auto note = [&order](char c) {
    return [&order, c](Job&) -> Result<void> {
      order += c;
      return {};
    };
  };
  ASSERT_TRUE(busy.queue.submit(Priority::batch, note('e')));
  ASSERT_TRUE(busy.queue.submit(Priority::interactive, note('c')));
  ASSERT_TRUE(busy.queue.submit(Priority::preview, note('a')));
  ASSERT_TRUE(busy.queue.submit(Priority::batch, note('f')));
  ASSERT_TRUE(busy.queue.submit(Priority::preview, note('b')));
  ASSERT_TRUE(busy.queue.submit(Priority::interactive, note('d')));
  busy.free();
  busy.queue.drain(kLong);
  EXPECT_EQ(order, "abcdef");
}

TEST(JobQueue, WorkIsDestroyedBeforeItsJobIsFinal) {
  JobQueue queue(1, 10);
  auto held = std::make_shared<int>(1);
  const std::weak_ptr<int> watch = held;
  const auto job = queue.submit(Priority::batch, [held = std::move(held)](Job&) -> Result<void> { return {}; }).value();
  ASSERT_TRUE(job->wait_for(kLong));
  EXPECT_TRUE(watch.expired());
}

TEST(JobQueue, DrainFinishesWhatIsThereAndTakesNothingNew) {
  BusyQueue busy(10);
  const auto waiting = busy.queue.submit(Priority::batch, [](Job&) -> Result<void> { return {}; }).value();
  std::jthread drainer([&] { busy.queue.drain(kLong); });
  while (true) {
    const auto late = busy.queue.submit(Priority::batch, [](Job&) -> Result<void> { return {}; });
    if (late) (*late)->request_cancel();
    if (!late && late.error().message.find("shutting down") != std::string::npos) break;
    std::this_thread::sleep_for(1ms);
  }
  busy.free();
  drainer.join();
  EXPECT_EQ(waiting->status().state, JobState::done);
  EXPECT_EQ(busy.blocker->status().state, JobState::done);
}

TEST(JobQueue, DrainCancelsWhatTakesTooLong) {
  JobQueue queue(1, 10);
  const auto running = queue.submit(Priority::batch, run_until_cancelled).value();
  const auto waiting = queue.submit(Priority::batch, run_until_cancelled).value();
  wait_until_running(*running);
  queue.drain(10ms);
  EXPECT_EQ(waiting->status().state, JobState::cancelled);
  EXPECT_TRUE(running->wait_for(kLong));
  EXPECT_EQ(running->status().state, JobState::cancelled);
}

TEST(JobQueue, DestructionCancelsAndWaits) {
  std::shared_ptr<Job> running, waiting;
  {
    JobQueue queue(1, 10);
    running = queue.submit(Priority::batch, run_until_cancelled).value();
    waiting = queue.submit(Priority::batch, run_until_cancelled).value();
    wait_until_running(*running);
  }
  EXPECT_EQ(running->status().state, JobState::cancelled);
  EXPECT_EQ(waiting->status().state, JobState::cancelled);
}

TEST(JobQueue, BellsMayAskTheQueue) {
  BusyQueue busy(10);
  const auto job = busy.queue.submit(Priority::batch, run_until_cancelled).value();
  std::atomic<int> rings = 0;
  const auto subscription = job->subscribe([&] {
    busy.queue.depth();
    ++rings;
  });
  busy.queue.drain(0ms);
  EXPECT_EQ(job->status().state, JobState::cancelled);
  EXPECT_EQ(rings, 1);
}

TEST(JobQueue, ManyThreadsSubmitWatchAndCancel) {
  JobQueue queue(3, 1000);
  std::atomic<int> rings = 0;
  std::atomic<int> final_jobs = 0;
  std::vector<std::jthread> clients;
  for (int c = 0; c < 4; ++c) {
    clients.emplace_back([&] {
      for (int i = 0; i < 50; ++i) {
        const auto job = queue
                             .submit(Priority(i % 3),
                                     [](Job& self) -> Result<void> {
                                       self.report("a", 0.5);
                                       self.report("b", 0.5);
                                       return {};
                                     })
                             .value();
        const auto subscription = job->subscribe([&] { ++rings; });
        if (i % 5 == 0) job->request_cancel();
        if (job->wait_for(kLong)) ++final_jobs;
      }
    });
  }
  clients.clear();
  EXPECT_EQ(final_jobs, 200);
  EXPECT_GT(rings, 0);
}

}  // namespace
}  // namespace geosis::server
