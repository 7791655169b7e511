#pragma once

#include <ostream>

#include "engine/base/result.h"
#include "engine/codec/position_map.h"
#include "engine/mesh/indexed_mesh.h"
#include "engine/mesh/vertex_attributes.h"

namespace geosis {

/// The mesh as binary little-endian PLY: double x, y, z of each mapped position, then uchar reliability, uint body and
/// float value, each where the attributes have it; int vertex_indices with a uchar count. Same vertices, same
/// triangles, full precision.
///
/// attributes  each array empty or of the mesh's number of vertices.
/// errors   unavailable: the stream refuses bytes (a full disk).
/// cost     24 to 33 bytes a vertex, 13 a triangle; memory: one buffer, whatever the size of the mesh.
Result<void> write_ply(std::ostream& stream, const IndexedMesh& mesh, const VertexAttributes& attributes,
                       const PositionMap& to_space);

}  // namespace geosis
