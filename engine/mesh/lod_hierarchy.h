#pragma once

#include <cstdint>
#include <vector>

#include "engine/mesh/indexed_mesh.h"

namespace geosis {

/// Why a level has more triangles than asked for.
enum class StoppedBy { none, floor, error_cap };

/// One level of detail and what making it took.
struct LodLevel {
  IndexedMesh mesh;
  /// (n) for each vertex the vertex of M0 that it descends from: of those merged into it, one that lay near its place
  /// in every merge, always of the same component. Empty where each vertex is its own.
  std::vector<std::int32_t> origin;
  StoppedBy stopped_by = StoppedBy::none;
  double cost = 0;   ///< largest quadric cost accepted so far, in squared voxels times area
  double error = 0;  ///< of a level asked for by error: the distance to M0 that was measured, in voxels
  std::int64_t dropped_components = 0;  ///< of M0, on this level or a finer one
};

/// Level 0 is the finest, M0.
struct LodHierarchy {
  std::vector<LodLevel> levels;
};

}  // namespace geosis
