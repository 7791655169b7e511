#pragma once

#include <cstddef>
#include <functional>
#include <memory>

#include "engine/base/result.h"
#include "server/jobs/job.h"

namespace geosis::server {

enum class Priority { preview, interactive, batch };

/// A bounded queue and the worker threads that empty it, higher priority first, then in order of arrival.
class JobQueue {
 public:
  using Work = std::function<Result<void>(Job&)>;

  JobQueue(int workers, std::size_t capacity);
  /// Cancels what is queued or running and waits for it.
  ~JobQueue();

  /// errors   unavailable: the queue is full, or draining.
  Result<std::shared_ptr<Job>> submit(Priority priority, Work work);
  /// Takes nothing new and returns when all is done or the time is over; what still runs then is cancelled.
  void drain(std::chrono::milliseconds grace);
  std::size_t depth() const;
};

}  // namespace geosis::server
