#include "server/jobs/handler_pool.h"

#include <cstdint>
#include <system_error>
#include <utility>

namespace geosis::server {

HandlerPool::HandlerPool(std::size_t threads, std::size_t most_queued)
    : most_queued_(most_queued), least_writers_(threads / 4), most_writers_(threads - threads / 4) {
  try {
    for (std::size_t i = 0; i < threads; ++i) threads_.emplace_back([this] { run(); });
  } catch (const std::system_error&) {  // a thread that runs must not be destroyed
    stop();
    throw;
  }
}

bool HandlerPool::submit(Lane lane, std::function<void()> work) {
  return add(lane, std::move(work), most_queued_);
}

bool HandlerPool::resume(Lane lane, std::function<void()> work) {
  return add(lane, std::move(work), SIZE_MAX);
}

bool HandlerPool::add(Lane lane, std::function<void()> work, std::size_t most_queued) {
  {
    const std::lock_guard lock(mutex_);
    if (is_stopping_ || queue(lane).size() >= most_queued) return false;
    queue(lane).push_back(std::move(work));
  }
  changed_.notify_one();
  return true;
}

void HandlerPool::stop() {
  {
    const std::lock_guard lock(mutex_);
    is_stopping_ = true;
  }
  changed_.notify_all();
  for (std::thread& thread : threads_) thread.join();
  threads_.clear();
  for (Queue& queue : queues_) queue.clear();
}

std::optional<HandlerPool::Lane> HandlerPool::next_lane() const {
  const bool has_writing = !queue(Lane::writing).empty();
  if (has_writing && writers_ < least_writers_) return Lane::writing;
  if (!queue(Lane::reading).empty()) return Lane::reading;
  if (has_writing && writers_ < most_writers_) return Lane::writing;
  return std::nullopt;
}

void HandlerPool::run() {
  std::unique_lock lock(mutex_);
  for (;;) {
    std::optional<Lane> lane;
    changed_.wait(lock, [&] { return is_stopping_ || (lane = next_lane()); });
    if (is_stopping_) return;
    const auto work = std::exchange(queue(*lane).front(), {});
    queue(*lane).pop_front();
    if (*lane == Lane::writing) ++writers_;
    lock.unlock();
    work();
    lock.lock();
    if (*lane == Lane::writing) --writers_;  // and this thread looks again
  }
}

}  // namespace geosis::server
