#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "engine/base/parallel.h"
#include "engine/structure/inline_planes.h"
#include "engine/structure/scan_dips.h"

namespace geosis {
namespace {

const double kOfRicker = std::sqrt(1.25);
constexpr std::int32_t kPlanes = 16;  // read at a time

/// Sums over one plane, relative to an offset that keeps squares small.
struct PlaneSums {
  double count = 0, sum = 0, squares = 0;
  double pairs = 0, differences = 0;  // of neighbours down a trace, squared

  void operator+=(const PlaneSums& other) {
    count += other.count;
    sum += other.sum;
    squares += other.squares;
    pairs += other.pairs;
    differences += other.differences;
  }
};

PlaneSums sums_of(const float* plane, std::size_t traces, std::size_t samples, double offset) {
  PlaneSums sums;
  for (std::size_t t = 0; t < traces; ++t) {
    double before = std::numeric_limits<double>::quiet_NaN();
    for (std::size_t k = 0; k < samples; ++k) {
      const double value = double{plane[t * samples + k]} - offset;
      if (std::isnan(value)) {
        before = value;
        continue;
      }
      ++sums.count;
      sums.sum += value;
      sums.squares += value * value;
      if (!std::isnan(before)) {
        ++sums.pairs;
        sums.differences += (value - before) * (value - before);
      }
      before = value;
    }
  }
  return sums;
}

}  // namespace

Result<VerticalScan> scan_vertically(const BrickedVolume& measured, int threads, const Progress& progress) {
  const GridShape shape = measured.shape();
  const ValueRange range = value_range(measured);
  const double offset = range.min <= range.max ? 0.5 * (double{range.min} + range.max) : 0;
  const auto traces = static_cast<std::size_t>(shape.crosslines), samples = static_cast<std::size_t>(shape.samples);
  PlaneSums all;
  for (std::int32_t first = 0; first < shape.inlines; first += kPlanes) {
    if (progress.cancelled()) return Error{ErrorCode::cancelled, "the search for dips was cancelled"};
    const std::int32_t end = std::min(first + kPlanes, shape.inlines);
    const auto box = read_planes(measured, first, end);
    if (!box) return box.error();
    std::vector<PlaneSums> sums(static_cast<std::size_t>(end - first));
    parallel_for(sums.size(), threads, [&](std::size_t i) {
      sums[i] = sums_of(box->value.data() + i * traces * samples, traces, samples, offset);
    });
    for (const PlaneSums& plane : sums) all += plane;
  }
  VerticalScan scan;
  if (all.count == 0) return scan;
  const double mean = all.sum / all.count, variance = all.squares / all.count - mean * mean;
  scan.mean = offset + mean;
  if (!(variance > 0) || !(all.differences > 0)) return scan;
  scan.deviation = std::sqrt(variance);
  // Neighbours of a sine of period P differ by 1 - cos(2 pi / P) in these units; noise alone gives 1. A wavelet holds
  // faster waves beside those of its strongest period: Ricker's looks faster by the root of 5/4.
  const double change = std::min(all.differences / all.pairs / (2 * variance), 2.0);
  scan.period = kOfRicker * 2 * std::numbers::pi / std::acos(1 - change);
  return scan;
}

}  // namespace geosis
