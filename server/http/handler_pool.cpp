#include "server/http/handler_pool.h"

#include <cstdint>
#include <system_error>
#include <utility>

namespace geosis::server::http {

HandlerPool::HandlerPool(std::size_t threads, std::size_t most_queued) : most_queued_(most_queued) {
  try {
    for (std::size_t i = 0; i < threads; ++i) threads_.emplace_back([this] { run(); });
  } catch (const std::system_error&) {  // a thread that runs must not be destroyed
    stop();
    throw;
  }
}

bool HandlerPool::submit(std::function<void()> work) {
  return add(std::move(work), most_queued_);
}

bool HandlerPool::resume(std::function<void()> work) {
  return add(std::move(work), SIZE_MAX);
}

bool HandlerPool::add(std::function<void()> work, std::size_t most_queued) {
  {
    const std::lock_guard lock(mutex_);
    if (is_stopping_ || queue_.size() >= most_queued) return false;
    queue_.push_back(std::move(work));
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
  queue_.clear();
}

void HandlerPool::run() {
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [this] { return is_stopping_ || !queue_.empty(); });
    if (is_stopping_) return;
    const auto work = std::exchange(queue_.front(), {});
    queue_.pop_front();
    lock.unlock();
    work();
    lock.lock();
  }
}

}  // namespace geosis::server::http
