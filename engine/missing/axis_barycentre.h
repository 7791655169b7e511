#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "engine/base/vec3.h"
#include "engine/missing/brick_row.h"
#include "engine/missing/brick_views.h"
#include "engine/missing/gaps/bit_lines.h"
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
/// valid or filled so, with their distances carried on, and so on. Three rounds are enough: a trace with a valid sample
/// is filled from top to bottom in the first one. A dead trace inside the outline has such traces on both sides on one
/// of its lines: some of it is filled in the first round, and the rest from that in the second. Where dead lines cross
/// it is one round later.
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
  /// From the nodes that an earlier round has reached; the same.
  std::uint64_t from_reached(const BitLines& reached, const BrickRow& row, std::uint64_t nodes, Row& estimates) const;
  template <class Take>
  void walk(const BrickRow& row, int axis, int way, std::uint64_t nodes, const BitLines& members,
            const Take& take) const;
  Estimate estimate_one(GridIndex node) const;

  std::size_t trace(std::int32_t i, std::int32_t j) const {
    return static_cast<std::size_t>(i) * shape_.crosslines + j;
  }

  const BrickViews& views_;
  const BitLines& valid_;
  GridShape shape_;
  Vec3d step_lengths_;
  std::vector<BitLines> reached_;  ///< valid, or filled in rounds 1, 2, ...; the last round's, all of them, is left out
};

}  // namespace geosis
