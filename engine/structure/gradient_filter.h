#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace geosis {

/// Filters for gradients: a Gaussian of sigma 1 node, and its derivative. Unlike differences of neighbours the
/// derivative is right for steep reflectors too: it weakens a wave by as much in each direction as it is fast.
inline constexpr std::int32_t kGradientReach = 4;
/// exp(-t^2 / 2), scaled to sum 1 over both sides.
inline constexpr std::array<float, kGradientReach + 1> kGradientSmooth = {0.39894347f, 0.24197145f, 0.053991127f,
                                                                          0.0044318616f, 0.00013383063f};
/// t exp(-t^2 / 2), scaled so that a slope of 1 gives 1; [t] is of the node t behind, with the other sign before.
inline constexpr std::array<float, kGradientReach + 1> kGradientSlope = {0, 0.24198887f, 0.10799003f, 0.013296542f,
                                                                         0.00053536104f};

/// out = the Gaussian mean, at row `middle`, of `rows` rows of `count` numbers given by row_at(n). The first and last
/// row go on beyond the ends.
template <class RowAt>
void smooth_among(float* out, std::int32_t middle, std::int32_t rows, std::size_t count, const RowAt& row_at) {
  const float* here = row_at(middle);
  for (std::size_t k = 0; k < count; ++k) out[k] = kGradientSmooth[0] * here[k];
  for (std::int32_t t = 1; t <= kGradientReach; ++t) {
    const float* before = row_at(std::max(middle - t, 0));
    const float* behind = row_at(std::min(middle + t, rows - 1));
    const float weight = kGradientSmooth[static_cast<std::size_t>(t)];
    for (std::size_t k = 0; k < count; ++k) out[k] += weight * (before[k] + behind[k]);
  }
}

/// The same for the slope from row to row.
template <class RowAt>
void slope_among(float* out, std::int32_t middle, std::int32_t rows, std::size_t count, const RowAt& row_at) {
  std::fill_n(out, count, 0.0f);
  for (std::int32_t t = 1; t <= kGradientReach; ++t) {
    const float* before = row_at(std::max(middle - t, 0));
    const float* behind = row_at(std::min(middle + t, rows - 1));
    const float weight = kGradientSlope[static_cast<std::size_t>(t)];
    for (std::size_t k = 0; k < count; ++k) out[k] += weight * (behind[k] - before[k]);
  }
}

/// Both along one row.
inline void filter_along_row(const float* row, std::size_t count, float* smooth, float* slope) {
  thread_local std::vector<float> padded;
  constexpr std::size_t kPad = kGradientReach;
  padded.resize(count + 2 * kPad);
  std::fill_n(padded.begin(), kPad, row[0]);
  std::copy_n(row, count, padded.begin() + kPad);
  std::fill_n(padded.end() - kPad, kPad, row[count - 1]);
  const float* middle = padded.data() + kPad;
  for (std::size_t k = 0; k < count; ++k) smooth[k] = kGradientSmooth[0] * middle[k];
  std::fill_n(slope, count, 0.0f);
  for (std::ptrdiff_t t = 1; t <= kGradientReach; ++t) {
    const float even = kGradientSmooth[static_cast<std::size_t>(t)], odd = kGradientSlope[static_cast<std::size_t>(t)];
    const float *before = middle - t, *behind = middle + t;
    for (std::size_t k = 0; k < count; ++k) {
      smooth[k] += even * (before[k] + behind[k]);
      slope[k] += odd * (behind[k] - before[k]);
    }
  }
}

}  // namespace geosis
