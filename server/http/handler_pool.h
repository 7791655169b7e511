#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace geosis::server::http {

/// A fixed number of threads that run handlers, fed by a bounded queue.
class HandlerPool {
 public:
  HandlerPool(std::size_t threads, std::size_t most_queued);
  ~HandlerPool() { stop(); }

  /// False when the queue is full or the pool stopped; the work was not taken. Work must not throw.
  bool submit(std::function<void()> work);
  /// The rest of work that was let in before: there is always room. False when the pool stopped.
  bool resume(std::function<void()> work);
  /// Work that has begun is finished, queued work is dropped.
  void stop();

 private:
  bool add(std::function<void()> work, std::size_t most_queued);
  void run();

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::function<void()>> queue_;
  std::size_t most_queued_;
  bool is_stopping_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace geosis::server::http
