#pragma once

#include <cstddef>
#include <vector>

#include "engine/base/result.h"
#include "engine/isosurface/brick_mesh.h"
#include "engine/mesh/indexed_mesh.h"
#include "engine/volume/brick_layout.h"

namespace geosis {

/// One mesh from the meshes of bricks: vertices and triangles in the order of the bricks given.
///
/// bricks   their numbers in the layout; meshes[n] belongs to bricks[n]. A brick that is not given holds no surface.
/// errors   limit_exceeded: more than max_triangles, or more vertices than int32 counts. malformed_input: bricks
///          that disagree on a shared layer (an index that does not fit the samples).
/// cost     O(result); the bricks' meshes are released as they are joined.
Result<IndexedMesh> weld_bricks(const BrickLayout& layout, const std::vector<std::size_t>& bricks,
                                std::vector<BrickMesh> meshes, std::int64_t max_triangles, int threads);

}  // namespace geosis
