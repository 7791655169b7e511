#pragma once

#include <vector>

#include "engine/base/result.h"
#include "engine/codec/mesh_part.h"

namespace geosis {

/// One mesh from the parts of a level: vertices with the same seam id become one, all others stay apart.
///
/// returns  triangles part after part; vertices numbered by their first appearance.
/// errors   malformed_input: two positions under one seam id (compared bit for bit), an id that only one part has, an
///          id beyond the number of vertices, a triangle that the join collapses, more than 2^31 - 1 vertices.
Result<IndexedMesh> join_parts(std::vector<MeshPart> parts);

}  // namespace geosis
