#pragma once

#include <array>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "engine/base/result.h"
#include "server/jobs/job.h"
#include "server/jobs/memory_budget.h"

namespace geosis::server {

enum class Priority { preview, interactive, batch };
inline constexpr std::size_t kPriorities = 3;
const char* name_of(Priority priority);

/// What a job asks of its queue.
struct JobDemand {
  Priority priority = Priority::interactive;
  std::uint64_t memory_bytes = 0;  ///< reserved while it runs
  std::string tenant = {};         ///< in whose name it waits
  std::string what = {};           ///< for those who watch: "extraction 12ab..."
  std::optional<std::chrono::steady_clock::time_point> deadline = std::nullopt;  ///< it fails when not done by then
};

/// How a job ended.
struct JobEnd {
  const JobDemand& demand;
  JobStatus status;
  std::chrono::duration<double> took;  ///< zero if it never ran
};

struct JobQueueOptions {
  int workers = 1;                       ///< at least one is started
  int preview_workers = 0;               ///< more, for previews alone: a preview never waits for something long
  int most_batch = 0;                    ///< batch jobs that may run at one time; 0 = as many as workers
  std::size_t capacity = 64;             ///< jobs that may wait; running ones do not count
  std::size_t tenant_capacity = 0;       ///< of these in the name of one tenant; 0 = all
  std::chrono::milliseconds longest{0};  ///< that a job may take from its start; 0 = any time
  MemoryBudget* budget = nullptr;        ///< what jobs reserve from; null = memory is not counted. Outlives the queue.
  /// Called by the worker whose job has ended; must not throw.
  std::function<void(const JobEnd&)> after_job = {};
  /// How long a job lets those of higher priority go first, by priority.
  std::array<std::chrono::milliseconds, kPriorities> patience = {std::chrono::seconds(0), std::chrono::seconds(5),
                                                                 std::chrono::seconds(60)};
  /// How long a job lets others go first for which there is memory while there is none for it.
  std::chrono::milliseconds memory_patience = std::chrono::seconds(10);
};

/// What a queue looks like at one moment, and what it has done.
struct JobQueueReport {
  struct Row {
    std::size_t waiting = 0, running = 0;
    std::uint64_t done = 0, failed = 0, cancelled = 0;
    double waited_seconds = 0;  ///< of all that were started
  };
  std::array<Row, kPriorities> rows;  ///< by priority
  std::size_t capacity = 0;
  bool is_draining = false;
  std::chrono::milliseconds longest_silence{0};  ///< of a running job, since it last asked whether to go on
};

/// A bounded queue and the worker threads that empty it. Each job is due when its priority's patience is over, and what
/// is due first runs first: higher priorities go first, in order of arrival, and nobody waits for ever.
class JobQueue {
 public:
  /// Returns cancelled when the job's cancelled() made it stop. An exception fails the job (internal).
  using Work = std::function<Result<void>(Job&)>;

  explicit JobQueue(const JobQueueOptions& options);
  JobQueue(int workers, std::size_t capacity) : JobQueue(JobQueueOptions{.workers = workers, .capacity = capacity}) {}
  JobQueue(const JobQueue&) = delete;
  JobQueue& operator=(const JobQueue&) = delete;
  ~JobQueue();  ///< stops

  /// A job that ran is final only after its work has been destroyed with all that it holds.
  ///
  /// errors   unavailable: the queue is full, or draining.  quota_exceeded: the tenant's places are taken.
  ///          limit_exceeded: it asks for more memory than there is at all.
  Result<std::shared_ptr<Job>> submit(JobDemand demand, Work work);
  Result<std::shared_ptr<Job>> submit(Priority priority, Work work) {
    return submit(JobDemand{.priority = priority}, std::move(work));
  }
  /// Takes nothing new and returns when all is done or the time is over; what still runs then is cancelled.
  void drain(std::chrono::milliseconds grace);
  /// Takes nothing new, cancels what is queued or running and waits for it. Whatever the work uses must live until
  /// then. May be called twice, but not by two threads at once.
  void stop();
  /// Jobs that wait.
  std::size_t depth() const;
  JobQueueReport report();
  /// When a place may be free, about: what waits, at the mean time of recent jobs, on all workers.
  std::chrono::duration<double> expected_wait() const;

 private:
  using Clock = std::chrono::steady_clock;
  struct Item {
    std::shared_ptr<Job> job;
    Work work;
    JobDemand demand;
    Clock::time_point submitted;
    MemoryBudget::Reservation memory;
  };
  using Waiting = std::multimap<Clock::time_point, Item>;  ///< by when they are due; equal ones in order of arrival
  struct Running {
    Priority priority;
    Clock::time_point started;
    std::uint64_t seen_signs = 0;  ///< of life, when report() last looked
    Clock::time_point seen_at;
  };
  enum class Lane { any, previews };

  static void run(Item& item);
  void run_worker(const std::stop_token& stop, Lane lane);
  bool take(const std::stop_token& stop, Lane lane, Item& item);
  bool start_next(Lane lane, Item& item);
  bool may_start(const Item& item, Lane lane) const;
  Result<void> check(const JobDemand& demand) const;
  std::chrono::duration<double> note_end(const Item& item);
  void cancel_all();
  std::vector<Item> take_cancelled();
  std::size_t waiting_of(const std::string& tenant) const;
  JobQueueReport::Row& row(Priority priority) { return rows_[static_cast<std::size_t>(priority)]; }
  bool is_idle() const { return waiting_.empty() && running_.empty(); }

  const JobQueueOptions options_;
  mutable std::mutex mutex_;  // guards all but threads_; never held while a job rings its bells
  std::condition_variable_any has_work_;
  std::condition_variable_any became_idle_;
  Waiting waiting_;
  std::map<std::shared_ptr<Job>, Running> running_;
  std::array<JobQueueReport::Row, kPriorities> rows_;
  std::chrono::duration<double> mean_run_{0};  ///< of jobs that ran, each older one counting less
  bool has_run_ = false;
  bool is_draining_ = false;
  std::vector<std::jthread> threads_;
};

}  // namespace geosis::server
