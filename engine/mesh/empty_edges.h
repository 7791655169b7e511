#pragma once

#include <cstdint>
#include <vector>

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/mesh/indexed_mesh.h"

namespace geosis {

/// Merges the ends of edges without length, wherever that keeps the topological type (has_link_condition): the surface
/// is the same set of points, with fewer triangles without area. Those that stay are needed, as where a body is so thin
/// that its two sides lie in one place.
///
/// mesh     manifold with or without boundary. What stays keeps its order.
/// returns  vertex -> its new index, or -1: it has become another, or no triangle uses it.
/// errors   those of build_corner_table; cancelled.
/// cost     O(triangles log valence) and some tenths of a microsecond an edge that goes; memory as a corner table.
Result<std::vector<std::int32_t>> collapse_empty_edges(IndexedMesh& mesh, const Progress& progress);

}  // namespace geosis
