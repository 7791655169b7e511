#pragma once

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/mesh/corner_table.h"
#include "engine/mesh/indexed_mesh.h"

namespace geosis {

/// Whether the corners at every vertex form one fan, open or closed: no two parts of the surface touch in a point.
///
/// errors   invalid_argument, naming the first vertex with several fans.  cancelled.
/// cost     O(triangles); 8 bytes a vertex.
Result<void> check_fans(const CornerTable& table, std::size_t vertices, const Progress& progress = NoProgress());

/// Whether the mesh is an oriented manifold, with or without boundary, by index: what build_corner_table and check_fans
/// check, and no two triangles on the same three vertices.
///
/// errors   invalid_argument: the first fault, by triangle and vertex indices.  limit_exceeded: see build_corner_table.
Result<void> check_manifold(const IndexedMesh& mesh);

}  // namespace geosis
