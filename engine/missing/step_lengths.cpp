#include "engine/missing/step_lengths.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace geosis {
namespace {

constexpr std::size_t kLanes = 8;
constexpr double kSmallestShare = 1.0 / 20;

/// Sums of one row in lanes that do not depend on each other: the order is fixed and the compiler may use vectors.
struct RowSums {
  std::array<double, kLanes> sum{}, squares{}, count{};

  template <bool kMissing>
  void add(std::size_t lane, double value) {
    const bool valid = !kMissing || value == value;
    sum[lane] += valid ? value : 0.0;
    squares[lane] += valid ? value * value : 0.0;
    count[lane] += valid ? 1.0 : 0.0;
  }
};

double total(const std::array<double, kLanes>& lanes) {
  double all = 0;
  for (const double lane : lanes) all += lane;
  return all;
}

/// value(k) for all k < n, in lanes.
template <bool kMissing, class Value>
RowSums sum_row(std::int32_t n, const Value& value) {
  RowSums sums;
  std::int32_t k = 0;
  for (; k + static_cast<std::int32_t>(kLanes) <= n; k += static_cast<std::int32_t>(kLanes))
    for (std::size_t lane = 0; lane < kLanes; ++lane)
      sums.add<kMissing>(lane, value(k + static_cast<std::int32_t>(lane)));
  for (std::size_t lane = 0; k < n; ++k, ++lane) sums.add<kMissing>(lane, value(k));
  return sums;
}

template <bool kMissing>
void add_differences(const float* from, const float* to, std::int32_t n, PairSum& sum) {
  const RowSums row = sum_row<kMissing>(n, [=](std::int32_t k) { return double{to[k]} - double{from[k]}; });
  sum.squares += total(row.squares);
  sum.pairs += static_cast<std::int64_t>(total(row.count));
}

/// One trace in `share`. Any good mixing of bits will do.
bool is_chosen(std::int32_t i, std::int32_t j, std::uint32_t share) {
  std::uint64_t mixed = static_cast<std::uint64_t>(i) << 32 | static_cast<std::uint32_t>(j);
  mixed = (mixed ^ mixed >> 33) * 0xFF51AFD7ED558CCDu;
  mixed = (mixed ^ mixed >> 33) * 0xC4CEB9FE1A85EC53u;
  return (mixed >> 32) % share == 0;
}

template <bool kMissing>
SampleSums sum_brick(const BrickView& brick, std::array<bool, 3> last, int lag, double pivot, std::uint32_t share) {
  SampleSums sums;
  const GridShape& extent = brick.extent;
  const GridShape own{extent.inlines - !last[0], extent.crosslines - !last[1], extent.samples - !last[2]};
  const std::ptrdiff_t to_crossline = std::ptrdiff_t{lag} * extent.samples;
  const std::ptrdiff_t to_inline = to_crossline * extent.crosslines;
  for (std::int32_t a = 0; a < own.inlines; ++a) {
    for (std::int32_t b = 0; b < own.crosslines; ++b) {
      if (share > 1 && !is_chosen(brick.first.i + a, brick.first.j + b, share)) continue;
      const float* row = brick.samples + (std::ptrdiff_t{a} * extent.crosslines + b) * extent.samples;
      const RowSums values = sum_row<kMissing>(own.samples, [=](std::int32_t k) { return double{row[k]} - pivot; });
      sums.sum += total(values.sum);
      sums.squares += total(values.squares);
      sums.valid += static_cast<std::int64_t>(total(values.count));
      if (a + lag < extent.inlines) add_differences<kMissing>(row, row + to_inline, own.samples, sums.axis[0]);
      if (b + lag < extent.crosslines) add_differences<kMissing>(row, row + to_crossline, own.samples, sums.axis[1]);
      add_differences<kMissing>(row, row + lag, extent.samples - lag, sums.axis[2]);
    }
  }
  return sums;
}

/// Half the mean squared difference in units of the variance; -1 without pairs.
double gamma(const PairSum& sum, double variance) {
  return sum.pairs == 0 ? -1 : sum.squares / static_cast<double>(sum.pairs) / (2 * variance);
}

}  // namespace

SampleSums& SampleSums::operator+=(const SampleSums& other) {
  sum += other.sum;
  squares += other.squares;
  valid += other.valid;
  for (std::size_t a = 0; a < 3; ++a) {
    axis[a].squares += other.axis[a].squares;
    axis[a].pairs += other.axis[a].pairs;
  }
  return *this;
}

SampleSums sum_samples(const BrickView& brick, std::array<bool, 3> last, bool has_missing, int lag, double pivot,
                       std::uint32_t row_share) {
  return has_missing ? sum_brick<true>(brick, last, lag, pivot, row_share)
                     : sum_brick<false>(brick, last, lag, pivot, row_share);
}

Vec3d step_lengths(const SampleSums& neighbours, const SampleSums& lag_two) {
  if (neighbours.valid == 0) return {1, 1, 1};
  const double mean = neighbours.sum / static_cast<double>(neighbours.valid);
  const double variance = neighbours.squares / static_cast<double>(neighbours.valid) - mean * mean;
  if (!(variance > 0)) return {1, 1, 1};
  Vec3d lengths;
  double largest = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    const double near = gamma(neighbours.axis[a], variance), far = gamma(lag_two.axis[a], variance);
    lengths[axis] = near >= 0 ? std::sqrt(near) : far >= 0 ? std::sqrt(far / 2) : -1;
    largest = std::max(largest, lengths[axis]);
  }
  if (!(largest > 0)) return {1, 1, 1};
  for (int axis = 0; axis < 3; ++axis)
    lengths[axis] = lengths[axis] < 0 ? largest : std::max(lengths[axis], largest * kSmallestShare);
  return lengths;
}

}  // namespace geosis
