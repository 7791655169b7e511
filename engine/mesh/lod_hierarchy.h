#pragma once

#include <vector>

#include "engine/mesh/indexed_mesh.h"

namespace geosis {

/// Why a level has more triangles than asked for.
enum class StoppedBy { none, floor, error_cap };

/// One level of detail and what making it took.
struct LodLevel {
  IndexedMesh mesh;
  double asked_ratio = 1;
  StoppedBy stopped_by = StoppedBy::none;
  double cost = 0;  ///< largest quadric cost accepted so far, in squared voxels times area
};

/// Level 0 is the finest, M0.
struct LodHierarchy {
  std::vector<LodLevel> levels;
};

}  // namespace geosis
