#pragma once

#include <algorithm>
#include <cmath>

#include "server/jobs/job_queue.h"

namespace geosis::server {

/// In how many seconds a refused caller may come again: the queue's expected wait, 1 to 60.
inline int retry_after(const JobQueue& queue) {
  return static_cast<int>(std::clamp(std::ceil(queue.expected_wait().count()), 1.0, 60.0));
}

}  // namespace geosis::server
