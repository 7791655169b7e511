#include "engine/structure/smoothing.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "engine/base/parallel.h"

namespace geosis {
namespace {

constexpr int kBoxes = 4;

/// Weights of one box filter of the given variance, from end to end: 1 inside, a fraction at both ends.
std::vector<double> box_filter(double variance) {
  int half = 0;
  while ((half + 1) * (half + 2) / 3.0 <= variance) ++half;
  const double width = 2 * half + 1;
  const double end =
      (variance * width - half * (half + 1) * width / 3) / (2 * ((half + 1.0) * (half + 1.0) - variance));
  std::vector<double> weight(static_cast<std::size_t>(2 * half + 3), 1 / (width + 2 * end));
  weight.front() *= end;
  weight.back() *= end;
  return weight;
}

std::vector<double> convolve(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> result(a.size() + b.size() - 1, 0.0);
  for (std::size_t m = 0; m < a.size(); ++m) {
    for (std::size_t n = 0; n < b.size(); ++n) result[m + n] += a[m] * b[n];
  }
  return result;
}

/// out += weight * (a + b), one row.
void add_pair(float* out, const float* a, const float* b, float weight, std::size_t count) {
  for (std::size_t k = 0; k < count; ++k) out[k] += weight * (a[k] + b[k]);
}

void add_one(float* out, const float* a, float weight, std::size_t count) {
  for (std::size_t k = 0; k < count; ++k) out[k] += weight * a[k];
}

}  // namespace

std::vector<float> smoothing_kernel(double sigma) {
  if (!(sigma > 0)) return {1.0f};
  const std::vector<double> box = box_filter(sigma * sigma / kBoxes);
  std::vector<double> whole = box;
  for (int n = 1; n < kBoxes; ++n) whole = convolve(whole, box);
  std::vector<float> half;
  for (std::size_t n = whole.size() / 2; n < whole.size() && whole[n] > 0; ++n) {
    half.push_back(static_cast<float>(whole[n]));
  }
  return half;
}

void smooth_across_rows(float* field, std::size_t rows, std::size_t stride, std::size_t count,
                        const std::vector<float>& kernel, std::vector<float>& scratch) {
  scratch.resize(rows * count);
  for (std::size_t r = 0; r < rows; ++r) std::copy_n(field + r * stride, count, &scratch[r * count]);
  for (std::size_t r = 0; r < rows; ++r) {
    float* out = field + r * stride;
    for (std::size_t k = 0; k < count; ++k) out[k] = kernel[0] * scratch[r * count + k];
    for (std::size_t t = 1; t < kernel.size(); ++t) {
      const bool below = r >= t, above = r + t < rows;
      if (below && above) {
        add_pair(out, &scratch[(r - t) * count], &scratch[(r + t) * count], kernel[t], count);
      } else if (below || above) {
        add_one(out, &scratch[(below ? r - t : r + t) * count], kernel[t], count);
      }
    }
  }
}

void smooth_along_row(float* row, std::size_t count, const std::vector<float>& kernel, std::vector<float>& scratch) {
  const std::size_t reach = kernel.size() - 1;
  scratch.assign(count + 2 * reach, 0.0f);
  float* middle = scratch.data() + reach;
  std::copy_n(row, count, middle);
  for (std::size_t k = 0; k < count; ++k) row[k] = kernel[0] * middle[k];
  for (std::size_t t = 1; t < kernel.size(); ++t) add_pair(row, middle - t, middle + t, kernel[t], count);
}

void smooth(std::span<float> field, GridShape shape, Vec3d sigma, int threads) {
  const auto inlines = static_cast<std::size_t>(shape.inlines);
  const auto crosslines = static_cast<std::size_t>(shape.crosslines);
  const auto samples = static_cast<std::size_t>(shape.samples);
  const std::vector<float> across_inlines = smoothing_kernel(sigma.x);
  const std::vector<float> across_crosslines = smoothing_kernel(sigma.y);
  const std::vector<float> along_samples = smoothing_kernel(sigma.z);
  parallel_for(inlines, threads, [&](std::size_t i) {
    std::vector<float> scratch;
    float* plane = field.data() + i * crosslines * samples;
    for (std::size_t j = 0; j < crosslines; ++j) {
      smooth_along_row(plane + j * samples, samples, along_samples, scratch);
    }
    smooth_across_rows(plane, crosslines, samples, samples, across_crosslines, scratch);
  });
  parallel_for(crosslines, threads, [&](std::size_t j) {
    std::vector<float> scratch;
    smooth_across_rows(field.data() + j * samples, inlines, crosslines * samples, samples, across_inlines, scratch);
  });
}

}  // namespace geosis
