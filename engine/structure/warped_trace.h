#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace geosis {

/// A trace with its ends repeated, to be read between and a little beyond its samples. NaN spreads over the four
/// samples around it.
///
/// pad   samples beyond the ends that may be asked for, less two. It decides how positions are rounded: another one
///       gives other last bits.
template <std::size_t kPad>
class PaddedTrace {
 public:
  void load(const float* samples, std::size_t count, double scale = 1) {
    padded_.resize(count + 2 * kPad);
    std::transform(samples, samples + count, padded_.begin() + kPad,
                   [=](float sample) { return static_cast<float>(sample * scale); });
    std::fill_n(padded_.begin(), kPad, padded_[kPad]);
    std::fill_n(padded_.end() - kPad, kPad, padded_[kPad + count - 1]);
  }

  struct Point {
    float value, slope;
  };
  /// Catmull-Rom's cubic at k + shift.
  Point point(std::size_t k, float shift) const {
    const float position = static_cast<float>(k + kPad) + shift;
    const auto below = static_cast<std::ptrdiff_t>(position);
    const float t = position - static_cast<float>(below);
    const float* x = padded_.data() + (below - 1);
    const float a = x[2] - x[0];
    const float b = 2 * x[0] - 5 * x[1] + 4 * x[2] - x[3];
    const float c = 3 * (x[1] - x[2]) + x[3] - x[0];
    return {x[1] + 0.5f * t * (a + t * (b + t * c)), 0.5f * (a + t * (2 * b + 3 * t * c))};
  }

 private:
  std::vector<float> padded_;
};

using WarpedTrace = PaddedTrace<16>;

}  // namespace geosis
