#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/base/vec3.h"
#include "engine/volume/brick_layout.h"
#include "engine/volume/bricks.h"

namespace geosis {

/// Positions sorted by the brick whose cells hold them, so that each brick is read once.
struct BrickGroups {
  std::vector<std::size_t> bricks;   ///< those with positions, rising
  std::vector<std::size_t> first;    ///< (bricks + 1) where each brick's positions start in `order`
  std::vector<std::uint32_t> order;  ///< (n) positions, those of one brick in their order

  std::span<const std::uint32_t> of(std::size_t group) const {
    return std::span(order).subspan(first[group], first[group + 1] - first[group]);
  }
};

/// positions   index coordinates inside the volume, fewer than 2^32.
BrickGroups group_by_brick(const BrickLayout& layout, std::span<const Vec3f> positions);

/// Trilinear value at a position in one of the brick's cells; NaN when a corner that has weight is missing. A corner
/// without weight (the position lies on the opposite face, edge or node) is not looked at. Exact for lattice positions
/// and small whole samples.
float interpolate(const BrickView& brick, Vec3f position);

/// Values of a volume at positions between its nodes: trilinear, NaN where a sample that counts is missing.
///
/// positions   index coordinates inside the volume.
/// errors      malformed_input: a damaged brick.  cancelled.
/// cost        reads each brick that holds a position once; 8 bytes a position beside the result.
Result<std::vector<float>> sample_at(const BrickedVolume& volume, std::span<const Vec3f> positions, int threads,
                                     const Progress& progress);

}  // namespace geosis
