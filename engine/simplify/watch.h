#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>

#include "engine/base/progress.h"

namespace geosis {

/// Counts removed triangles over all threads, reports their share and asks whether to go on.
class Watch {
 public:
  /// to_remove   triangles between M0 and the last level.
  Watch(Progress& progress, std::int64_t to_remove) : progress_(progress), to_remove_(to_remove) {}

  bool is_cancelled() const { return progress_.cancelled(); }

  /// False once the work is cancelled.
  bool removed(std::int64_t triangles) {
    const std::int64_t all = removed_ += triangles;
    const double share = static_cast<double>(all) / static_cast<double>(std::max<std::int64_t>(to_remove_, 1));
    progress_.report("simplify", std::min(share, 1.0));
    return !progress_.cancelled();
  }

 private:
  Progress& progress_;
  const std::int64_t to_remove_;
  std::atomic<std::int64_t> removed_ = 0;
};

}  // namespace geosis
