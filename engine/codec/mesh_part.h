#pragma once

#include <cstdint>
#include <vector>

#include "engine/mesh/indexed_mesh.h"
#include "engine/mesh/vertex_attributes.h"

namespace geosis {

/// One part of a level, with its own vertex numbering.
///
/// seams (n), one a vertex: 0, or the id that the vertex has in every part that uses it. Empty when the level is one
/// part.
struct MeshPart {
  IndexedMesh mesh;
  std::vector<std::uint32_t> seams = {};
  VertexAttributes attributes = {};
};

}  // namespace geosis
