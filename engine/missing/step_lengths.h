#pragma once

#include <array>
#include <cstdint>

#include "engine/base/vec3.h"
#include "engine/volume/bricks.h"

namespace geosis {

/// Squared differences of valid samples `lag` nodes apart on one axis.
struct PairSum {
  double squares = 0;
  std::int64_t pairs = 0;
};

/// Sums over valid samples, from which step lengths follow.
struct SampleSums {
  double sum = 0, squares = 0;  ///< of the samples minus a pivot
  std::int64_t valid = 0;
  std::array<PairSum, 3> axis;

  SampleSums& operator+=(const SampleSums& other);
};

/// The sums of one brick. Every node and every pair of the volume is counted in one brick only, although bricks share
/// layers; of the pairs with lag 2, those that no brick holds whole are left out.
///
/// row_share     of the brick's traces, one in so many counts, chosen by a hash of its place: whatever the pattern in
///               which traces are missing, the choice is not in step with it. 1 = all.
/// last          whether the brick is the last one of each axis, which owns its last layer
/// has_missing   false promises that all samples are valid
/// cost          one read of the brick
SampleSums sum_samples(const BrickView& brick, std::array<bool, 3> last, bool has_missing, int lag, double pivot,
                       std::uint32_t row_share);

/// How much the field changes from a node to the next one on each axis: sqrt(mean squared difference / twice the
/// variance), so that distances on different axes can be compared. Between 1/20 of the largest and the largest.
///
/// An axis without neighbouring pairs (every second trace missing) takes those with lag 2, else the largest of the
/// others. A field that is constant, or has no pairs at all, gets 1 on each axis.
Vec3d step_lengths(const SampleSums& neighbours, const SampleSums& lag_two);

}  // namespace geosis
