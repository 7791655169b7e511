#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "engine/base/result.h"
#include "engine/base/vec3.h"
#include "engine/volume/grid.h"

namespace geosis {

/// World positions of a grid's nodes, in their order, to float32 from the first of them: to a millimetre over ten
/// kilometres. The same positions give the same bits, whoever asks.
class NodeOffsets {
 public:
  /// errors   malformed_input: an axis with less than two nodes.
  static Result<NodeOffsets> begin(GridShape shape);

  /// Appends the offsets of the next nodes to `offsets`.
  ///
  /// errors   malformed_input: one that is not finite, further from the first than float32 reaches, or one too many.
  ///          The message says which and what.
  Result<void> add(std::span<const Vec3d> nodes, std::vector<Vec3f>& offsets);
  /// errors   malformed_input: not all nodes have come.
  Result<void> end() const;

  GridShape shape() const { return shape_; }
  Vec3d origin() const { return origin_; }
  /// The box of the nodes, in the world.
  Vec3d low() const { return low_; }
  Vec3d high() const { return high_; }

 private:
  explicit NodeOffsets(GridShape shape) : shape_(shape) {}

  static constexpr double kInfinity = std::numeric_limits<double>::infinity();

  GridShape shape_;
  std::size_t count_ = 0;
  Vec3d origin_;
  Vec3d low_{kInfinity, kInfinity, kInfinity}, high_{-kInfinity, -kInfinity, -kInfinity};
};

/// A line that carries the nodes of one trace.
struct Pillar {
  Vec3d top, bottom;
};

/// errors   malformed_input: an end that is not finite, or both at one depth.
Result<void> check_pillar(GridShape shape, std::size_t trace, const Pillar& pillar);

/// Where on the pillar that depth is, beyond its ends too.
inline Vec3d point_on(const Pillar& pillar, double depth) {
  const double share = (depth - pillar.top.z) / (pillar.bottom.z - pillar.top.z);
  return {pillar.top.x + (pillar.bottom.x - pillar.top.x) * share,
          pillar.top.y + (pillar.bottom.y - pillar.top.y) * share, depth};
}

}  // namespace geosis
