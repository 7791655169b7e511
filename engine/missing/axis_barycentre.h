#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "engine/base/vec3.h"
#include "engine/missing/bit_lines.h"
#include "engine/missing/brick_row.h"
#include "engine/missing/brick_views.h"
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

/// The axis barycentre: fills any missing node inside the outline, whatever else is filled.
///
/// The nearest valid samples on the node's three lines decide. A node that meets none takes the nearest nodes that are
/// valid or filled so, with their distances carried on. That second step always ends: the node lies on a dead trace
/// (a valid one has a valid sample on its k line); a dead trace inside the outline has valid traces on all four sides,
/// and these are filled from top to bottom.
class AxisBarycentre {
 public:
  /// Estimate k of a row, for sample first_k() + k.
  using Row = std::array<Estimate, kBrickSamples>;

  /// valid   one line a trace, i * crosslines + j; like the views, it must outlive the object.
  /// inside  of the outline, by trace
  AxisBarycentre(const BrickViews& views, const BitLines& valid, Vec3d step_lengths,
                 const std::vector<std::uint8_t>& inside);

  /// Estimates the nodes of a row whose bits are set: missing ones inside the outline.
  /// cost: 64 nodes take one step on a lateral line together, so a wide gap takes about as many as it has nodes.
  void estimate(const BrickRow& row, std::uint64_t nodes, Row& estimates) const;

 private:
  struct Met;
  /// From valid samples alone; returns the nodes that met any.
  std::uint64_t from_valid(const BrickRow& row, std::uint64_t nodes, Row& estimates) const;
  void from_reached(const BrickRow& row, std::uint64_t nodes, Row& estimates) const;
  template <class Take>
  void walk(const BrickRow& row, int axis, int way, std::uint64_t nodes, const BitLines& members,
            const Take& take) const;
  Estimate one_from_valid(GridIndex node) const;

  std::size_t trace(std::int32_t i, std::int32_t j) const {
    return static_cast<std::size_t>(i) * shape_.crosslines + j;
  }

  const BrickViews& views_;
  const BitLines& valid_;
  GridShape shape_;
  Vec3d step_lengths_;
  std::optional<BitLines> reached_;  ///< valid, or met by the first step; only if there are others to fill
};

}  // namespace geosis
