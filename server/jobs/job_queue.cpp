#include "server/jobs/job_queue.h"

#include <algorithm>
#include <exception>
#include <iterator>
#include <utility>

#include "engine/base/parallel.h"

namespace geosis::server {
namespace {

constexpr std::chrono::milliseconds kLongestGrace = std::chrono::hours(24 * 365);  // now + time must not overflow
constexpr double kNewestShare = 1.0 / 8;                                           // of the mean time of jobs

Result<void> call(const JobQueue::Work& work, Job& job) {
  try {
    return work(job);
  } catch (const std::exception& problem) {
    return Error{ErrorCode::internal, std::string("a job ended with an exception: ") + problem.what()};
  } catch (...) {
    return Error{ErrorCode::internal, "a job ended with an exception of unknown type"};
  }
}

LoopPriority loop_priority(Priority priority) {
  switch (priority) {
    case Priority::preview:
      return LoopPriority::high;
    case Priority::interactive:
      return LoopPriority::normal;
    case Priority::batch:
      return LoopPriority::low;
  }
  return LoopPriority::low;
}

}  // namespace

const char* name_of(Priority priority) {
  switch (priority) {
    case Priority::preview:
      return "preview";
    case Priority::interactive:
      return "interactive";
    case Priority::batch:
      return "batch";
  }
  return "batch";
}

JobQueue::JobQueue(const JobQueueOptions& options) : options_(options) {
  if (options_.budget) {
    options_.budget->on_release([this] {
      { const std::lock_guard lock(mutex_); }  // a worker that has just looked is waiting by now
      has_work_.notify_all();
    });
  }
  const auto start = [this](Lane lane) {
    threads_.emplace_back([this, lane](const std::stop_token& stop) { run_worker(stop, lane); });
  };
  for (int i = 0; i < std::max(options_.workers, 1); ++i) start(Lane::any);
  for (int i = 0; i < options_.preview_workers; ++i) start(Lane::previews);
}

JobQueue::~JobQueue() {
  stop();
  if (options_.budget) options_.budget->on_release({});
}

void JobQueue::stop() {
  {
    const std::lock_guard lock(mutex_);
    is_draining_ = true;
  }
  cancel_all();
  for (auto& thread : threads_) thread.request_stop();
  threads_.clear();        // joins
  std::vector<Item> left;  // what no worker could take
  const std::lock_guard lock(mutex_);
  left = take_cancelled();
}

Result<std::shared_ptr<Job>> JobQueue::submit(JobDemand demand, Work work) {
  auto job = std::make_shared<Job>(demand.deadline);
  std::vector<Item> cancelled;  // destroyed without the lock: work may hold anything
  {
    const std::lock_guard lock(mutex_);
    auto fits = check(demand);
    if (!fits && fits.error().code != ErrorCode::limit_exceeded && !is_draining_) {
      cancelled = take_cancelled();
      fits = check(demand);
    }
    if (!fits) return std::move(fits).error();
    const auto now = Clock::now();
    const auto due = now + options_.patience[static_cast<std::size_t>(demand.priority)];
    waiting_.emplace(due, Item{job, std::move(work), std::move(demand), now, {}});
  }
  has_work_.notify_all();  // not every worker takes every job
  return job;
}

/// Whether there is a place for it.
Result<void> JobQueue::check(const JobDemand& demand) const {
  if (is_draining_) return Error{ErrorCode::unavailable, "the server is shutting down"};
  if (options_.budget && !options_.budget->can_ever_hold(demand.memory_bytes)) {
    return Error{ErrorCode::limit_exceeded, "this needs about " + std::to_string(demand.memory_bytes) +
                                                " bytes of memory; the server may use " +
                                                std::to_string(options_.budget->total())};
  }
  if (waiting_.size() >= options_.capacity) {
    return Error{ErrorCode::unavailable, "the queue is full: " + std::to_string(options_.capacity) + " jobs wait"};
  }
  if (options_.tenant_capacity > 0 && waiting_of(demand.tenant) >= options_.tenant_capacity) {
    return Error{ErrorCode::quota_exceeded,
                 std::to_string(options_.tenant_capacity) + " jobs of this tenant wait already"};
  }
  return {};
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
  return waiting_.size();
}

std::chrono::duration<double> JobQueue::expected_wait() const {
  const std::lock_guard lock(mutex_);
  return mean_run_ * static_cast<double>(waiting_.size()) / std::max(options_.workers, 1);
}

JobQueueReport JobQueue::report() {
  const std::lock_guard lock(mutex_);
  JobQueueReport report{.rows = rows_, .capacity = options_.capacity, .is_draining = is_draining_};
  for (const auto& [due, item] : waiting_) ++report.rows[static_cast<std::size_t>(item.demand.priority)].waiting;
  const auto now = Clock::now();
  for (auto& [job, running] : running_) {
    ++report.rows[static_cast<std::size_t>(running.priority)].running;
    if (const auto signs = job->signs_of_life(); signs != running.seen_signs) {
      running.seen_signs = signs;
      running.seen_at = now;
    }
    const auto silence = std::chrono::duration_cast<std::chrono::milliseconds>(now - running.seen_at);
    report.longest_silence = std::max(report.longest_silence, silence);
  }
  return report;
}

// ---- the workers

void JobQueue::run(Item& item) {
  const LoopPriorityScope loops(loop_priority(item.demand.priority));
  item.job->set_running();
  if (is_final(item.job->status().state)) {  // cancelled while it waited
    item.work = nullptr;
    return;
  }
  auto outcome = item.job->is_late() ? Error{ErrorCode::cancelled, "too late"} : call(item.work, *item.job);
  item.work = nullptr;
  item.memory = {};
  item.job->finish(std::move(outcome));
}

void JobQueue::run_worker(const std::stop_token& stop, Lane lane) {
  Item item;
  while (take(stop, lane, item)) {
    run(item);
    const auto took = note_end(item);
    if (options_.after_job) options_.after_job({item.demand, item.job->status(), took});
    item = {};
  }
}

std::chrono::duration<double> JobQueue::note_end(const Item& item) {
  const JobState state = item.job->status().state;
  std::chrono::duration<double> took{0};
  {
    const std::lock_guard lock(mutex_);
    const auto ended = running_.extract(item.job);
    if (ended) took = Clock::now() - ended.mapped().started;
    if (ended && state != JobState::cancelled) {
      mean_run_ = has_run_ ? mean_run_ + (took - mean_run_) * kNewestShare : took;
      has_run_ = true;
    }
    JobQueueReport::Row& counts = row(item.demand.priority);
    ++(state == JobState::done ? counts.done : state == JobState::failed ? counts.failed : counts.cancelled);
    if (is_idle()) became_idle_.notify_all();
  }
  has_work_.notify_all();  // a batch job may start now
  return took;
}

/// Waits for the next job; false when the thread shall end.
bool JobQueue::take(const std::stop_token& stop, Lane lane, Item& item) {
  std::unique_lock lock(mutex_);
  return has_work_.wait(lock, stop, [&] { return start_next(lane, item); });
}

/// Takes the first job in the order of their dues that may start. One that is kept waiting for memory lets those after
/// it go first, but not for ever: then memory gathers until it fits.
bool JobQueue::start_next(Lane lane, Item& item) {
  const auto now = Clock::now();
  for (auto next = waiting_.begin(); next != waiting_.end(); ++next) {
    if (!may_start(next->second, lane)) continue;
    std::optional<MemoryBudget::Reservation> memory = MemoryBudget::Reservation();
    const bool has_ended = is_final(next->second.job->status().state);
    if (options_.budget && !has_ended) memory = options_.budget->reserve(next->second.demand.memory_bytes);
    if (!memory) {
      if (now - next->second.submitted > options_.memory_patience) return false;
      continue;
    }
    item = std::move(next->second);
    item.memory = *std::move(memory);
    waiting_.erase(next);
    if (options_.longest.count() > 0) item.job->limit_time(now + options_.longest);
    running_[item.job] = {item.demand.priority, now, item.job->signs_of_life(), now};
    row(item.demand.priority).waited_seconds += std::chrono::duration<double>(now - item.submitted).count();
    return true;
  }
  return false;
}

bool JobQueue::may_start(const Item& item, Lane lane) const {
  if (lane == Lane::previews) return item.demand.priority == Priority::preview;
  if (item.demand.priority != Priority::batch || options_.most_batch <= 0) return true;
  const auto is_batch = [](const auto& running) { return running.second.priority == Priority::batch; };
  return std::count_if(running_.begin(), running_.end(), is_batch) < options_.most_batch;
}

void JobQueue::cancel_all() {
  std::vector<std::shared_ptr<Job>> jobs;
  {
    const std::lock_guard lock(mutex_);
    for (const auto& [job, running] : running_) jobs.push_back(job);
    for (const auto& [due, item] : waiting_) jobs.push_back(item.job);
  }
  for (const auto& job : jobs) job->request_cancel();
  has_work_.notify_all();  // they need no memory any more
}

/// A job that was cancelled while it waited still has its place until here or until its turn comes.
std::vector<JobQueue::Item> JobQueue::take_cancelled() {
  std::vector<Item> cancelled;
  for (auto next = waiting_.begin(); next != waiting_.end();) {
    if (!is_final(next->second.job->status().state)) {
      ++next;
      continue;
    }
    cancelled.push_back(std::move(next->second));
    next = waiting_.erase(next);
  }
  return cancelled;
}

std::size_t JobQueue::waiting_of(const std::string& tenant) const {
  return static_cast<std::size_t>(std::count_if(
      waiting_.begin(), waiting_.end(), [&](const auto& waiting) { return waiting.second.demand.tenant == tenant; }));
}

}  // namespace geosis::server
