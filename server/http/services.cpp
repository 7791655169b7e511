#include "server/http/services.h"

#include <chrono>
#include <utility>

namespace geosis::server::http {

Result<void> run_on_worker(Services services, const JobQueue::Work& work) {
  const auto seat = services.waiting.take();
  if (!seat) return Error{ErrorCode::unavailable, "too many requests wait for results"};
  auto job = services.queue.submit(Priority::interactive, work);
  if (!job) return std::move(job).error();
  while (!(*job)->wait_for(std::chrono::hours(1))) {
  }
  const JobStatus status = (*job)->status();
  if (status.state == JobState::done) return {};
  return status.error.value_or(Error{ErrorCode::cancelled, "the server is stopping"});
}

}  // namespace geosis::server::http
