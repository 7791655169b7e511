#include "server/jobs/job_queue.h"

#include <algorithm>
#include <exception>
#include <iterator>
#include <string>
#include <utility>

namespace geosis::server {
namespace {

constexpr std::chrono::milliseconds kLongestGrace = std::chrono::hours(24 * 365);  // now + time must not overflow

Result<void> call(const JobQueue::Work& work, Job& job) {
  try {
    return work(job);
  } catch (const std::exception& problem) {
    return Error{ErrorCode::internal, std::string("a job ended with an exception: ") + problem.what()};
  } catch (...) {
    return Error{ErrorCode::internal, "a job ended with an exception of unknown type"};
  }
}

}  // namespace

void JobQueue::run(Item& item) {
  item.job->set_running();
  if (is_final(item.job->status().state)) {  // cancelled while it waited
    item.work = nullptr;
    return;
  }
  auto outcome = call(item.work, *item.job);
  item.work = nullptr;
  item.job->finish(std::move(outcome));
}

JobQueue::JobQueue(int workers, std::size_t capacity) : capacity_(capacity) {
  for (int i = 0; i < std::max(workers, 1); ++i)
    threads_.emplace_back([this](const std::stop_token& stop) { run_worker(stop); });
}

JobQueue::~JobQueue() {
  stop();
}

void JobQueue::stop() {
  {
    const std::lock_guard lock(mutex_);
    is_draining_ = true;
  }
  cancel_all();
  for (auto& thread : threads_) thread.request_stop();
  threads_.clear();  // joins
}

Result<std::shared_ptr<Job>> JobQueue::submit(Priority priority, Work work) {
  auto job = std::make_shared<Job>();
  std::vector<Item> cancelled;  // destroyed without the lock: work may hold anything
  {
    const std::lock_guard lock(mutex_);
    if (is_draining_) return Error{ErrorCode::unavailable, "the server is shutting down"};
    if (waiting() >= capacity_) cancelled = take_cancelled();
    if (waiting() >= capacity_)
      return Error{ErrorCode::unavailable, "the queue is full: " + std::to_string(capacity_) + " jobs wait"};
    queues_[static_cast<std::size_t>(priority)].push_back({job, std::move(work)});
  }
  has_work_.notify_one();
  return job;
}

void JobQueue::drain(std::chrono::milliseconds grace) {
  bool is_done = false;
  {
    std::unique_lock lock(mutex_);
    is_draining_ = true;
    is_done = became_idle_.wait_for(lock, std::min(grace, kLongestGrace), [&] { return is_idle(); });
  }
  if (!is_done) cancel_all();
}

std::size_t JobQueue::depth() const {
  const std::lock_guard lock(mutex_);
  return waiting();
}

void JobQueue::run_worker(const std::stop_token& stop) {
  Item item;
  while (take(stop, item)) {
    run(item);
    const std::lock_guard lock(mutex_);
    std::erase(running_, item.job);
    if (is_idle()) became_idle_.notify_all();
  }
}

// Waits for the next job; false when the thread shall end.
bool JobQueue::take(const std::stop_token& stop, Item& item) {
  std::unique_lock lock(mutex_);
  if (!has_work_.wait(lock, stop, [&] { return waiting() > 0; })) return false;
  const auto queue = std::find_if(queues_.begin(), queues_.end(), [](const auto& items) { return !items.empty(); });
  item = std::move(queue->front());
  queue->pop_front();
  running_.push_back(item.job);
  return true;
}

void JobQueue::cancel_all() {
  std::vector<std::shared_ptr<Job>> jobs;
  {
    const std::lock_guard lock(mutex_);
    jobs = running_;
    for (const auto& queue : queues_)
      for (const auto& item : queue) jobs.push_back(item.job);
  }
  for (const auto& job : jobs) job->request_cancel();
}

// A job that was cancelled while it waited still has its place until here or until its turn comes.
std::vector<JobQueue::Item> JobQueue::take_cancelled() {
  std::vector<Item> cancelled;
  for (auto& queue : queues_) {
    const auto first = std::stable_partition(queue.begin(), queue.end(),
                                             [](const Item& item) { return !is_final(item.job->status().state); });
    std::move(first, queue.end(), std::back_inserter(cancelled));
    queue.erase(first, queue.end());
  }
  return cancelled;
}

std::size_t JobQueue::waiting() const {
  std::size_t count = 0;
  for (const auto& queue : queues_) count += queue.size();
  return count;
}

}  // namespace geosis::server
