#include "server/jobs/job.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace geosis::server {
namespace {

constexpr std::chrono::milliseconds kQuietTime{100};
constexpr double kAudibleProgress = 0.01;
// Longer waits are cut: now + time must not overflow.
constexpr std::chrono::milliseconds kLongestWait = std::chrono::hours(24 * 365);

}  // namespace

const char* name_of(JobState state) {
  switch (state) {
    case JobState::queued:
      return "queued";
    case JobState::running:
      return "running";
    case JobState::done:
      return "done";
    case JobState::failed:
      return "failed";
    case JobState::cancelled:
      return "cancelled";
  }
  return "failed";
}

// The lock is held while the bell rings, so ending waits for that. It is recursive for a bell that ends its own
// subscription; such a bell lives on until it returns.
struct Job::Subscription::Entry {
  std::recursive_mutex mutex;
  std::function<void()> bell;
  bool is_ringing = false;
  bool is_ended = false;

  void ring() {
    const std::lock_guard lock(mutex);
    if (is_ended) return;
    is_ringing = true;
    bell();
    is_ringing = false;
  }

  void end() {
    const std::lock_guard lock(mutex);
    is_ended = true;
    if (!is_ringing) bell = nullptr;
  }
};

Job::Subscription& Job::Subscription::operator=(Subscription&& other) noexcept {
  if (this != &other) {
    end();
    entry_ = std::move(other.entry_);
  }
  return *this;
}

void Job::Subscription::end() {
  if (entry_) entry_->end();
  entry_.reset();
}

// Applies a change under the lock and rings outside of it when the change says so.
template <class Apply>
void Job::change(Apply apply) {
  {
    const std::lock_guard lock(mutex_);
    if (!apply()) return;
    if (is_final(status_.state)) became_final_.notify_all();
  }
  ring_bells();
}

void Job::report(const char* stage, double fraction) {
  change([&] {
    if (is_final(status_.state)) return false;
    const bool is_new_stage = status_.stage != stage;
    if (is_new_stage) status_.stage = stage;
    status_.progress = fraction >= 0 ? std::min(fraction, 1.0) : 0.0;
    ++status_.version;
    const auto now = Clock::now();
    const bool is_audible =
        std::abs(status_.progress - rung_progress_) >= kAudibleProgress && now - rung_at_ >= kQuietTime;
    if (!is_new_stage && !is_audible) return false;
    rung_progress_ = status_.progress;
    rung_at_ = now;
    return true;
  });
}

void Job::limit_time(Clock::time_point deadline) {
  for (auto known = deadline_.load(); deadline < known && !deadline_.compare_exchange_weak(known, deadline);) {
  }
}

bool Job::is_late() const {
  const auto deadline = deadline_.load(std::memory_order_relaxed);
  return deadline != Clock::time_point::max() && Clock::now() >= deadline;
}

bool Job::cancelled() const {
  signs_of_life_.fetch_add(1, std::memory_order_relaxed);
  return cancel_requested_.load(std::memory_order_relaxed) || is_late();
}

void Job::request_cancel() {
  cancel_requested_.store(true, std::memory_order_relaxed);
  change([&] {
    if (status_.state != JobState::queued) return false;
    status_.state = JobState::cancelled;
    ++status_.version;
    return true;
  });
}

JobStatus Job::status() const {
  const std::lock_guard lock(mutex_);
  return status_;
}

void Job::set_running() {
  change([&] {
    if (status_.state != JobState::queued) return false;
    status_.state = JobState::running;
    ++status_.version;
    return true;
  });
}

void Job::finish(Result<void> outcome) {
  change([&] {
    if (is_final(status_.state)) return false;
    if (outcome) {
      status_.state = JobState::done;
    } else if (outcome.error().code == ErrorCode::cancelled && !cancel_requested_ && is_late()) {
      status_.state = JobState::failed;
      status_.error = Error{ErrorCode::deadline_exceeded, "it was not done within the time it may take"};
    } else if (outcome.error().code == ErrorCode::cancelled) {
      status_.state = JobState::cancelled;
    } else {
      status_.state = JobState::failed;
      status_.error = std::move(outcome).error();
    }
    ++status_.version;
    return true;
  });
}

void Job::ring() {
  change([&] {
    ++status_.version;
    return true;
  });
}

void Job::ring_bells() {
  std::vector<std::shared_ptr<Subscription::Entry>> ringing;
  {
    const std::lock_guard lock(mutex_);
    std::erase_if(bells_, [](const auto& bell) { return bell.expired(); });
    for (const auto& bell : bells_)
      if (auto entry = bell.lock()) ringing.push_back(std::move(entry));
  }
  for (const auto& entry : ringing) entry->ring();
}

Job::Subscription Job::subscribe(std::function<void()> bell) {
  auto entry = std::make_shared<Subscription::Entry>();
  entry->bell = std::move(bell);
  const std::lock_guard lock(mutex_);
  std::erase_if(bells_, [](const auto& known) { return known.expired(); });
  bells_.push_back(entry);
  return Subscription(std::move(entry));
}

bool Job::wait_for(std::chrono::milliseconds time) const {
  std::unique_lock lock(mutex_);
  return became_final_.wait_for(lock, std::min(time, kLongestWait), [&] { return is_final(status_.state); });
}

Result<void> Job::outcome() const {
  const JobStatus now = status();
  if (now.state == JobState::done) return {};
  return now.error.value_or(Error{ErrorCode::cancelled, "cancelled"});
}

}  // namespace geosis::server
