#pragma once

#include <limits>

namespace geosis {

struct ThinPlateOptions {
  double tolerance = 1e-3;  ///< residual, as a share of that of a gap filled with the mean of the samples round it
  /// What the result is clamped to: the range of the valid samples.
  float low = std::numeric_limits<float>::lowest();
  float high = std::numeric_limits<float>::max();
};

}  // namespace geosis
