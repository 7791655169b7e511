#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "engine/base/progress.h"
#include "engine/base/vec3.h"
#include "engine/missing/bit_lines.h"
#include "engine/missing/brick_views.h"
#include "engine/missing/node_set.h"
#include "engine/volume/grid.h"

namespace geosis {

/// What the samples around a missing node say about it.
struct Estimate {
  double value = 0;
  double distance = -1;  ///< effective, in step lengths; below zero: nothing was met
};

/// Value and effective distance from the nearest samples on either side of each axis, [axis][before, after].
///
/// With w = 1 / distance, an axis with samples on both sides (a pair) contributes their w-mean, which is linear
/// interpolation, with weight (w + w')^2; a field that is linear on the axes comes back exactly. Only if no axis has a
/// pair do single samples count, with weight w^2. The effective distance is 1 / (sum of all w that took part), and
/// twice that without a pair.
Estimate combine(const std::array<std::array<Estimate, 2>, 3>& met);

/// How far a filled sample can be trusted: 0 .. 254 for 0 .. 1, 1 / (1 + (distance / 0.4)^3).
std::uint8_t reliability_of(double distance);

/// The axis barycentre: fills any missing node inside the outline, each by itself.
///
/// The nearest valid samples on the node's three lines decide. A node that meets none takes the nearest nodes that are
/// valid or filled so, with their distances carried on. That second step always ends: the node lies on a dead trace
/// (a valid one has a valid sample on its k line); a dead trace inside the outline has valid traces on all four sides,
/// and these are filled from top to bottom.
class AxisBarycentre {
 public:
  /// inside  of the outline, by trace. Both references must outlive the object.
  AxisBarycentre(const BrickViews& views, BitLines valid, Vec3d step_lengths, const std::vector<std::uint8_t>& inside,
                 int threads, const Progress& progress);

  const NodeSet& valid() const { return valid_; }
  /// A missing node inside the outline. cost: O(width of the gap / 64) and six samples.
  Estimate at(GridIndex node) const;

 private:
  Estimate from_valid(GridIndex node) const;
  Estimate from_reached(GridIndex node) const;

  const BrickViews& views_;
  Vec3d step_lengths_;
  NodeSet valid_;
  std::optional<NodeSet> reached_;  ///< valid, or met by the first step; only if there are others to fill
};

}  // namespace geosis
