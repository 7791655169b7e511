#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "engine/base/progress.h"
#include "engine/missing/bit_lines.h"
#include "engine/volume/grid.h"

namespace geosis {

/// A set of the volume's nodes that answers, for a node and an axis, which member is nearest on either side.
///
/// Bits are kept along each of the three axes: about 3 bits a node, 50 MB for 512^3.
class NodeSet {
 public:
  /// along_k  the members, one line a trace: line i * crosslines + j.
  /// A set built while progress was cancelled is incomplete.
  NodeSet(GridShape shape, BitLines along_k, int threads, const Progress& progress);

  GridShape shape() const { return shape_; }
  const BitLines& along_k() const { return along_[2]; }
  bool contains(GridIndex node) const { return along_[2].test(line(2, node), node.k); }

  /// Members next to the node on its line, -1 = none on that side.
  struct Neighbours {
    std::int32_t before, after;
  };
  Neighbours neighbours(int axis, GridIndex node) const {
    if (shape_[axis] == 1) return {-1, -1};
    const std::size_t number = line(axis, node);
    return {along_[axis].before(number, node[axis]), along_[axis].after(number, node[axis])};
  }

 private:
  std::size_t line(int axis, GridIndex node) const {
    const std::int32_t major = axis == 0 ? node.j : node.i, minor = axis == 2 ? node.j : node.k;
    return static_cast<std::size_t>(major) * (axis == 2 ? shape_.crosslines : shape_.samples) + minor;
  }
  void turn_inline(std::int32_t i);
  void turn_crossline(std::int32_t j);

  GridShape shape_;
  std::array<BitLines, 3> along_;  ///< that of an axis of one node stays empty
};

}  // namespace geosis
