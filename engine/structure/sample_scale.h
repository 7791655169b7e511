#pragma once

#include <algorithm>
#include <cmath>
#include <span>

namespace geosis {

/// The power of two that brings the largest size of the samples into [0.5, 1), so that squares of them neither overflow
/// nor vanish; 1 when all are zero or NaN.
inline double power_of_two_scale(std::span<const float> samples) {
  float largest = 0;
  for (const float sample : samples) {
    if (std::isfinite(sample)) largest = std::max(largest, std::abs(sample));
  }
  if (largest == 0) return 1;
  int exponent = 0;
  std::frexp(largest, &exponent);
  return std::ldexp(1.0, -exponent);
}

}  // namespace geosis
