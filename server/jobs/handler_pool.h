#pragma once

#include <array>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

namespace geosis::server {

/// A fixed number of threads that run handlers, fed by two bounded queues: what writes to the store's disk takes long
/// and never keeps what reads from being answered.
class HandlerPool {
 public:
  enum class Lane { reading, writing };

  /// most_queued   of each lane.
  HandlerPool(std::size_t threads, std::size_t most_queued);
  ~HandlerPool() { stop(); }

  /// False when the lane's queue is full or the pool stopped; the work was not taken. Work must not throw.
  bool submit(Lane lane, std::function<void()> work);
  /// The rest of work that was let in before: there is always room. False when the pool stopped.
  bool resume(Lane lane, std::function<void()> work);
  /// Work that has begun is finished, queued work is dropped.
  void stop();

 private:
  using Queue = std::deque<std::function<void()>>;

  bool add(Lane lane, std::function<void()> work, std::size_t most_queued);
  void run();
  /// The lane that a free thread serves now.
  std::optional<Lane> next_lane() const;
  Queue& queue(Lane lane) { return queues_[static_cast<std::size_t>(lane)]; }
  const Queue& queue(Lane lane) const { return queues_[static_cast<std::size_t>(lane)]; }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::array<Queue, 2> queues_;
  const std::size_t most_queued_;
  const std::size_t least_writers_, most_writers_;  ///< threads that writing may always have, and may ever have
  std::size_t writers_ = 0;
  bool is_stopping_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace geosis::server
