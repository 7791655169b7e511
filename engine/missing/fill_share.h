#pragma once

#include <atomic>
#include <cstddef>

#include "engine/base/progress.h"

namespace geosis {

/// A share of the stage "fill" that is done in equal parts, from any threads.
class FillShare {
 public:
  FillShare(Progress& progress, double from, double to, std::size_t parts)
      : progress_(progress), from_(from), to_(to), parts_(parts) {}

  bool cancelled() const { return progress_.cancelled(); }
  void done() {
    progress_.report("fill", from_ + (to_ - from_) * static_cast<double>(++done_) / static_cast<double>(parts_));
  }

 private:
  Progress& progress_;
  double from_, to_;
  std::size_t parts_;
  std::atomic<std::size_t> done_ = 0;
};

}  // namespace geosis
