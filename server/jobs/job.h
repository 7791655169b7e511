#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/progress.h"
#include "engine/base/result.h"

namespace geosis::server {

enum class JobState { queued, running, done, failed, cancelled };
const char* name_of(JobState state);
constexpr bool is_final(JobState state) {
  return state == JobState::done || state == JobState::failed || state == JobState::cancelled;
}

struct JobStatus {
  JobState state = JobState::queued;
  std::string stage;
  double progress = 0;         ///< of the stage, 0 .. 1
  std::optional<Error> error;  ///< of a failed job
  std::uint64_t version = 0;   ///< raised with every change
};

/// One piece of work as others see it: state, progress, cancellation, and a bell that rings when something changes.
/// Knows nothing of what is computed. Every member may be called from any thread.
class Job final : public Progress {
 public:
  using Clock = std::chrono::steady_clock;

  /// deadline   from then on cancelled() is true, and the job fails unless it is done.
  explicit Job(std::optional<Clock::time_point> deadline = std::nullopt) {
    if (deadline) limit_time(*deadline);
  }

  /// Rings at every new stage, else at most every 100 ms and only when 1 % was added.
  void report(const char* stage, double fraction) override;
  bool cancelled() const override;
  /// How often cancelled() was asked: a job whose number stands still makes no progress.
  std::uint64_t signs_of_life() const { return signs_of_life_.load(std::memory_order_relaxed); }
  /// Moves the deadline, if that is earlier than the one there is.
  void limit_time(Clock::time_point deadline);
  bool is_late() const;
  /// A queued job is cancelled at once; a running one learns of it by asking cancelled().
  void request_cancel();

  JobStatus status() const;
  /// Moves to a new state. A final state stays.
  void set_running();
  /// done; failed; cancelled when the error's code says so, but failed when it was the deadline that stopped it.
  void finish(Result<void> outcome);

  /// Rings all bells; for whoever adds news of his own to a job.
  void ring();
  /// Calls bell() after every change, from whatever thread made it, until the subscription is destroyed; never while
  /// holding the job's lock, and never twice at a time. When the destructor returns, bell() is not running and will not
  /// be called; it may run inside bell() itself. A bell must be quick, must not throw, change its job or end another
  /// subscription. The job may be gone before its subscriptions.
  class [[nodiscard]] Subscription {
   public:
    Subscription() = default;
    Subscription(Subscription&&) noexcept = default;
    Subscription& operator=(Subscription&& other) noexcept;
    ~Subscription() { end(); }

   private:
    friend class Job;
    struct Entry;
    explicit Subscription(std::shared_ptr<Entry> entry) : entry_(std::move(entry)) {}
    void end();

    std::shared_ptr<Entry> entry_;
  };
  Subscription subscribe(std::function<void()> bell);
  /// Waits until the job is final or the time is over; true when final.
  bool wait_for(std::chrono::milliseconds time) const;
  /// How a final job ended: the error of one that failed or was cancelled.
  Result<void> outcome() const;

 private:
  template <class Apply>
  void change(Apply apply);
  void ring_bells();

  std::atomic<Clock::time_point> deadline_{Clock::time_point::max()};
  std::atomic<bool> cancel_requested_{false};
  mutable std::atomic<std::uint64_t> signs_of_life_{0};
  mutable std::mutex mutex_;  // guards all below
  mutable std::condition_variable became_final_;
  JobStatus status_;
  double rung_progress_ = 0;  // of the stage, when the bells last rang
  Clock::time_point rung_at_{};
  std::vector<std::weak_ptr<Subscription::Entry>> bells_;
};

}  // namespace geosis::server
