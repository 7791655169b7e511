#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/base/vec3.h"
#include "engine/volume/grid.h"

namespace geosis {

/// One half of a symmetric smoothing kernel, [0] in the middle, that stands for a Gaussian: four equal box filters,
/// whose ends have a fractional weight, one after the other. Its variance is sigma squared exactly, its sum 1, its
/// reach at most 2 sqrt(3) sigma + 4; no exponential is evaluated, so that it is the same everywhere.
///
/// sigma    in nodes, not below zero; 0 = the kernel that changes nothing.
std::vector<float> smoothing_kernel(double sigma);

/// Smooths a field in place along the three axes, as if it were zero outside.
///
/// field    shape.count() finite numbers, sample fastest.
/// sigma    in nodes, one an axis.
/// cost     O(count * (sum of sigma)); memory: one plane of the field a thread. The same for any number of threads.
void smooth(std::span<float> field, GridShape shape, Vec3d sigma, int threads);

/// Rows of `count` numbers, `stride` apart: each becomes the kernel's mean of its neighbours, zero beyond the last
/// ones. scratch grows to rows * count.
void smooth_across_rows(float* field, std::size_t rows, std::size_t stride, std::size_t count,
                        const std::vector<float>& kernel, std::vector<float>& scratch);

/// The numbers of one row among themselves.
void smooth_along_row(float* row, std::size_t count, const std::vector<float>& kernel, std::vector<float>& scratch);

/// out = the kernel's mean around row `middle` of `rows` rows, each given by row_at(n): for rows that lie anywhere.
template <class RowAt>
void smooth_row_among(float* out, std::int32_t middle, std::int32_t rows, std::size_t count,
                      const std::vector<float>& kernel, const RowAt& row_at);

template <class RowAt>
void smooth_row_among(float* out, std::int32_t middle, std::int32_t rows, std::size_t count,
                      const std::vector<float>& kernel, const RowAt& row_at) {
  const float* here = row_at(middle);
  for (std::size_t k = 0; k < count; ++k) out[k] = kernel[0] * here[k];
  for (std::int32_t t = 1; t < static_cast<std::int32_t>(kernel.size()); ++t) {
    const float weight = kernel[static_cast<std::size_t>(t)];
    if (middle - t >= 0) {
      const float* row = row_at(middle - t);
      for (std::size_t k = 0; k < count; ++k) out[k] += weight * row[k];
    }
    if (middle + t < rows) {
      const float* row = row_at(middle + t);
      for (std::size_t k = 0; k < count; ++k) out[k] += weight * row[k];
    }
  }
}

}  // namespace geosis
