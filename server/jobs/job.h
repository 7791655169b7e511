#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>

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
  void report(const char* stage, double fraction) override;  ///< rings at most every 100 ms per stage change or 1 %
  bool cancelled() const override { return cancel_requested_.load(std::memory_order_relaxed); }
  void request_cancel();

  JobStatus status() const;
  /// Moves to a new state. A final state stays.
  void set_running();
  void finish(Result<void> outcome);  ///< done; cancelled when the error's code says so; else failed

  /// Rings all bells; for whoever adds news of his own to a job.
  void ring();
  /// Calls bell() after every change, from whatever thread made it, until the subscription is destroyed; never while
  /// holding the job's lock. When the destructor returns, bell() is not running and will not be called.
  class Subscription {
   public:
    Subscription() = default;
    Subscription(Subscription&&) noexcept;
    Subscription& operator=(Subscription&&) noexcept;
    ~Subscription();

   private:
    friend class Job;
    struct Entry;
    std::shared_ptr<Entry> entry_;
  };
  Subscription subscribe(std::function<void()> bell);
  /// Waits until the job is final or the time is over; true when final.
  bool wait_for(std::chrono::milliseconds time) const;

 private:
  // state behind one mutex, a condition variable, the list of bells
};

}  // namespace geosis::server
