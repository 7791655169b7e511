#pragma once

#include <array>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <stop_token>
#include <thread>
#include <vector>

#include "engine/base/result.h"
#include "server/jobs/job.h"

namespace geosis::server {

enum class Priority { preview, interactive, batch };

/// A bounded queue and the worker threads that empty it, higher priority first, then in order of arrival.
class JobQueue {
 public:
  /// Returns cancelled when the job's cancelled() made it stop. An exception fails the job (internal).
  using Work = std::function<Result<void>(Job&)>;

  /// workers    at least one thread is started.
  /// capacity   jobs that may wait; running ones do not count.
  JobQueue(int workers, std::size_t capacity);
  JobQueue(const JobQueue&) = delete;
  JobQueue& operator=(const JobQueue&) = delete;
  ~JobQueue();  ///< stops

  /// A job that ran is final only after its work has been destroyed with all that it holds.
  ///
  /// errors   unavailable: the queue is full, or draining.
  Result<std::shared_ptr<Job>> submit(Priority priority, Work work);
  /// Takes nothing new and returns when all is done or the time is over; what still runs then is cancelled.
  void drain(std::chrono::milliseconds grace);
  /// Takes nothing new, cancels what is queued or running and waits for it. Whatever the work uses must live until
  /// then. May be called twice, but not by two threads at once.
  void stop();
  /// Jobs that wait.
  std::size_t depth() const;

 private:
  struct Item {
    std::shared_ptr<Job> job;
    Work work;
  };
  static constexpr std::size_t kPriorities = 3;

  static void run(Item& item);
  void run_worker(const std::stop_token& stop);
  bool take(const std::stop_token& stop, Item& item);
  void cancel_all();
  std::vector<Item> take_cancelled();
  std::size_t waiting() const;
  bool is_idle() const { return waiting() == 0 && running_.empty(); }

  const std::size_t capacity_;
  mutable std::mutex mutex_;  // guards all but threads_; never held while a job rings its bells
  std::condition_variable_any has_work_;
  std::condition_variable_any became_idle_;
  std::array<std::deque<Item>, kPriorities> queues_;
  std::vector<std::shared_ptr<Job>> running_;
  bool is_draining_ = false;
  std::vector<std::jthread> threads_;
};

}  // namespace geosis::server
