#pragma once

#include <ostream>

#include "engine/base/result.h"
#include "engine/codec/position_map.h"
#include "engine/mesh/indexed_mesh.h"

namespace geosis {

/// The mesh as binary little-endian PLY: double x, y, z of each mapped position and int vertex_indices with a uchar
/// count. Same vertices, same triangles, full precision.
///
/// errors   unavailable: the stream refuses bytes (a full disk).
/// cost     24 bytes a vertex, 13 a triangle; memory: one buffer, whatever the size of the mesh.
Result<void> write_ply(std::ostream& stream, const IndexedMesh& mesh, const PositionMap& to_space);

}  // namespace geosis
