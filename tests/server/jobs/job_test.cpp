#include "server/jobs/job.h"

#include <atomic>
#include <chrono>
#include <limits>
#include <memory>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace geosis::server {
namespace {

using namespace std::chrono_literals;

// A subscription that counts how often its bell rang.
struct Counter {
  explicit Counter(Job& job) : subscription(job.subscribe([this] { ++count; })) {}
  std::atomic<int> count = 0;
  Job::Subscription subscription;
};

TEST(JobState, HasTheNamesOfTheDocuments) {
  EXPECT_STREQ(name_of(JobState::queued), "queued");
  EXPECT_STREQ(name_of(JobState::running), "running");
  EXPECT_STREQ(name_of(JobState::done), "done");
  EXPECT_STREQ(name_of(JobState::failed), "failed");
  EXPECT_STREQ(name_of(JobState::cancelled), "cancelled");
}

TEST(Job, GoesFromQueuedOverRunningToDone) {
  Job job;
  EXPECT_EQ(job.status().state, JobState::queued);
  job.set_running();
  EXPECT_EQ(job.status().state, JobState::running);
  job.finish({});
  EXPECT_EQ(job.status().state, JobState::done);
  EXPECT_FALSE(job.status().error);
}

TEST(Job, ThatFailsKeepsItsError) {
  Job job;
  job.set_running();
  job.finish(Error{ErrorCode::no_space, "full"});
  EXPECT_EQ(job.status().state, JobState::failed);
  EXPECT_EQ(job.status().error->code, ErrorCode::no_space);
  EXPECT_EQ(job.status().error->message, "full");
}

TEST(Job, WhoseErrorIsCancelledIsCancelled) {
  Job job;
  job.set_running();
  job.finish(Error{ErrorCode::cancelled, "stopped"});
  EXPECT_EQ(job.status().state, JobState::cancelled);
  EXPECT_FALSE(job.status().error);
}

TEST(Job, StaysInItsFinalState) {
  Job job;
  job.finish({});
  const auto version = job.status().version;
  job.set_running();
  job.request_cancel();
  job.report("late", 0.5);
  job.finish(Error{ErrorCode::internal, "late"});
  EXPECT_EQ(job.status().state, JobState::done);
  EXPECT_EQ(job.status().stage, "");
  EXPECT_EQ(job.status().version, version);
}

TEST(Job, IsCancelledAtOnceWhileQueued) {
  Job job;
  const Counter rings(job);
  job.request_cancel();
  EXPECT_EQ(job.status().state, JobState::cancelled);
  EXPECT_EQ(rings.count, 1);
}

TEST(Job, ThatRunsLearnsOfItsCancellation) {
  Job job;
  job.set_running();
  EXPECT_FALSE(job.cancelled());
  job.request_cancel();
  EXPECT_TRUE(job.cancelled());
  EXPECT_EQ(job.status().state, JobState::running);
}

TEST(Job, ShowsTheLastReport) {
  Job job;
  job.report("extract", 0.25);
  EXPECT_EQ(job.status().stage, "extract");
  EXPECT_EQ(job.status().progress, 0.25);
  job.report("extract", 7);
  EXPECT_EQ(job.status().progress, 1);
  job.report("encode", std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(job.status().progress, 0);
}

TEST(Job, RaisesItsVersionWithEveryChange) {
  Job job;
  std::uint64_t last = job.status().version;
  const std::vector<std::function<void()>> changes = {[&] { job.set_running(); }, [&] { job.report("a", 0.1); },
                                                      [&] { job.report("a", 0.1001); }, [&] { job.ring(); },
                                                      [&] { job.finish({}); }};
  for (const auto& change : changes) {
    change();
    EXPECT_GT(job.status().version, last);
    last = job.status().version;
  }
}

TEST(Job, RingsForStagesAndSparinglyForProgress) {
  Job job;
  const Counter rings(job);
  job.report("extract", 0);
  EXPECT_EQ(rings.count, 1);
  for (int i = 1; i < 90; ++i) job.report("extract", i / 100.0);  // within 100 ms unless the machine stalls
  EXPECT_LE(rings.count, 5);
  const int before = rings.count;
  job.report("encode", 0);
  EXPECT_EQ(rings.count, before + 1);
  std::this_thread::sleep_for(110ms);
  job.report("encode", 0.001);
  EXPECT_EQ(rings.count, before + 1);
  job.report("encode", 0.02);
  EXPECT_EQ(rings.count, before + 2);
}

TEST(Job, RingsOutsideItsLock) {
  Job job;
  JobState seen = JobState::queued;
  const auto subscription = job.subscribe([&] { seen = job.status().state; });
  job.set_running();
  EXPECT_EQ(seen, JobState::running);
}

TEST(Job, RingsNobodyWhoLeft) {
  Job job;
  int rings = 0;
  {
    auto subscription = job.subscribe([&] { ++rings; });
    auto moved = std::move(subscription);
    job.ring();
    moved = Job::Subscription();
    job.ring();
  }
  job.ring();
  EXPECT_EQ(rings, 1);
}

TEST(Job, SubscriptionMayEndInsideItsBell) {
  Job job;
  auto subscription = std::make_unique<Job::Subscription>();
  int rings = 0;
  const auto witness = std::make_shared<int>(7);
  *subscription = job.subscribe([&, witness] {
    subscription.reset();
    rings += *witness;  // what the bell holds is still there
  });
  job.ring();
  job.ring();
  EXPECT_EQ(rings, 7);
  EXPECT_EQ(witness.use_count(), 1);
}

TEST(Job, SubscriptionMayOutliveItsJob) {
  auto job = std::make_unique<Job>();
  const auto subscription = job->subscribe([] {});
  job.reset();
}

TEST(Job, NoBellRunsAfterItsSubscriptionEnded) {
  Job job;
  std::atomic<bool> stop = false;
  std::jthread ringer([&] {
    while (!stop) job.ring();
  });
  for (int i = 0; i < 300; ++i) {
    auto alive = std::make_unique<std::atomic<int>>(0);
    auto subscription = job.subscribe([&counter = *alive] { ++counter; });
    if (i % 3 == 0) std::this_thread::yield();
    subscription = Job::Subscription();
    alive.reset();  // a later bell would write into freed memory
  }
  stop = true;
}

TEST(Job, EndingASubscriptionWaitsForItsBell) {
  Job job;
  std::atomic<bool> is_ringing = false;
  std::atomic<bool> has_rung = false;
  auto subscription = job.subscribe([&] {
    is_ringing = true;
    std::this_thread::sleep_for(30ms);
    has_rung = true;
  });
  std::jthread ringer([&] { job.ring(); });
  while (!is_ringing) std::this_thread::yield();
  subscription = Job::Subscription();
  EXPECT_TRUE(has_rung);
}

TEST(Job, WaitEndsWithTheJobOrTheTime) {
  Job job;
  EXPECT_FALSE(job.wait_for(5ms));
  std::jthread finisher([&] {
    std::this_thread::sleep_for(10ms);
    job.set_running();
    job.finish({});
  });
  EXPECT_TRUE(job.wait_for(std::chrono::milliseconds::max()));
  EXPECT_TRUE(job.wait_for(0ms));
}

}  // namespace
}  // namespace geosis::server
