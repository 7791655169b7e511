#include "engine/missing/plate/thin_plate.h"

#include <algorithm>
#include <cassert>

#include "engine/missing/plate/narrow_plate.h"
#include "engine/missing/plate/plate_gaps.h"
#include "engine/missing/plate/plate_rows.h"
#include "engine/missing/plate/wide_plate.h"

namespace geosis {
namespace {

constexpr std::size_t kGapsBetweenAsking = 1024;

/// c_a = 1 / h_a^2, the largest 1.
Vec3d plate_weights(const Vec3d& step_lengths) {
  const double shortest = std::min({step_lengths.x, step_lengths.y, step_lengths.z});
  Vec3d weights;
  for (int axis = 0; axis < 3; ++axis) {
    const double share = shortest / step_lengths[axis];
    weights[axis] = share * share;
  }
  return weights;
}

/// A gap of one node has one equation.
void fill_single(GapBox& gap, const std::vector<PlateNode>& nodes, const ThinPlateOptions& options) {
  PlateRows rows({1, 1, 1});
  const auto strides = PlateNeighbours(gap).strides();
  for (const PlateNode& node : nodes) {
    const PlateRow& row = rows[rows.number(node.available)];
    double pull = 0;
    for (int m = 1; m < kPlateReach; ++m)
      if (row[m] != 0) pull -= row[m] * static_cast<double>(gap.samples.value[node.place + strides[m]]);
    float& value = gap.samples.value[node.place];
    value = clamped(row[0] > 0 ? pull / row[0] : static_cast<double>(value), options);
  }
}

}  // namespace

void fill_thin_plate(GapBox& gap, const Vec3d& step_lengths, const ThinPlateOptions& options,
                     const Progress& progress) {
  assert(step_lengths.x > 0 && step_lengths.y > 0 && step_lengths.z > 0);
  const PlateGaps gaps = find_plate_gaps(gap, progress);
  if (progress.cancelled()) return;
  fill_single(gap, gaps.single, options);
  const Vec3d weights = plate_weights(step_lengths);
  if (std::any_of(gaps.gaps.begin(), gaps.gaps.end(), [](const PlateGap& one) { return !one.wide; })) {
    NarrowPlate narrow(gap, gaps, weights, options, progress);
    for (std::size_t n = 0; n < gaps.gaps.size(); ++n) {
      if (n % kGapsBetweenAsking == 0 && progress.cancelled()) return;
      if (!gaps.gaps[n].wide) narrow.solve(gaps.gaps[n]);
    }
  }
  for (const PlateGap& one : gaps.gaps) {
    if (progress.cancelled()) return;
    if (one.wide) {
      const auto nodes = std::span(gaps.nodes).subspan(one.first, one.last - one.first);
      fill_wide_plate(gap, nodes, weights, options, progress);
    }
  }
}

}  // namespace geosis
