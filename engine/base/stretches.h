#pragma once

#include <algorithm>
#include <cstddef>

#include "engine/base/progress.h"

namespace geosis {

/// A long loop in stretches, between which it asks whether to go on: what lies within a stretch pays nothing for it.
///
///     Stretches stretches(mesh.triangles.size(), progress);
///     while (stretches.next()) {
///       for (std::size_t t = stretches.begin(); t < stretches.end(); ++t) ...
///     }
///     if (stretches.are_cancelled()) return Error{ErrorCode::cancelled, "..."};
class Stretches {
 public:
  static constexpr std::size_t kLength = std::size_t{1} << 16;

  Stretches(std::size_t count, const Progress& progress) : count_(count), progress_(progress) {}

  /// False at the end, and when it is cancelled.
  bool next() {
    if (end_ == count_ || are_cancelled_) return false;
    are_cancelled_ = progress_.cancelled();
    begin_ = end_;
    end_ = std::min(count_, begin_ + kLength);
    return !are_cancelled_;
  }
  std::size_t begin() const { return begin_; }
  std::size_t end() const { return end_; }
  bool are_cancelled() const { return are_cancelled_; }

 private:
  const std::size_t count_;
  const Progress& progress_;
  std::size_t begin_ = 0, end_ = 0;
  bool are_cancelled_ = false;
};

}  // namespace geosis
