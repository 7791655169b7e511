#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/base/result.h"
#include "engine/isosurface/brick_bodies.h"
#include "engine/volume/brick_layout.h"

namespace geosis {

/// Which body each brick's pieces belong to, bodies numbered as their first pieces come.
struct JoinedBodies {
  std::int32_t count = 0;
  std::vector<std::int32_t> first_piece;  ///< [n]: where the pieces of bricks[n] begin in `body`
  std::vector<std::int32_t> body;         ///< [piece]
};

/// Joins pieces over the layers that bricks share.
///
/// bricks   their numbers in the layout; parts[n] belongs to bricks[n]. A brick that is not given holds no body.
/// errors   limit_exceeded: more pieces than int32 counts. Bricks that disagree on a layer (a damaged index) are joined
///          where they agree: weld_bricks refuses them.
/// cost     near enough O(vertices and runs of nodes on shared layers).
Result<JoinedBodies> join_bodies(const BrickLayout& layout, const std::vector<std::size_t>& bricks,
                                 const std::vector<BrickBodies>& parts);

}  // namespace geosis
