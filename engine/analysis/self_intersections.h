#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "engine/mesh/indexed_mesh.h"

namespace geosis {

/// Pairs of triangles of one mesh that meet outside the corners and edges they share, decided exactly on the lattice.
///
/// Corners are shared by position: copies of one vertex at a contact touch, they do not intersect. Touching anywhere
/// else counts, and so do two triangles with the same three corners. Triangles without area meet nothing.
///
/// mesh     every position on the lattice, less than 2^17 voxels from the origin; indices in range. Manifold or not.
/// returns  pairs (a, b) with a < b, ascending; the same for any number of threads.
/// cost     O(triangles) where triangles are of similar size; about 100 bytes a triangle.
std::vector<std::array<std::int32_t, 2>> find_intersecting_pairs(const IndexedMesh& mesh, int threads);

/// The number of those pairs.
std::int64_t count_intersecting_pairs(const IndexedMesh& mesh, int threads);

}  // namespace geosis
