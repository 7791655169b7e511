#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "engine/mesh/indexed_mesh.h"

namespace geosis {

/// Surface inside one brick, with its own vertex numbers.
///
/// Vertices on a brick's last layer of nodes belong to the next brick. Both bricks number the vertices of a shared
/// layer in the same order, so the n-th of upper_layer[axis] is the n-th of the next brick's lower_layer[axis].
struct BrickMesh {
  std::vector<Vec3f> positions;
  std::vector<Triangle> triangles;
  std::array<std::vector<std::int32_t>, 3> lower_layer, upper_layer;  ///< vertices, in order of creation
};

}  // namespace geosis
