#pragma once

#include <cstdint>

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/mesh/indexed_mesh.h"

namespace geosis {

/// What a mesh is, by index.
struct TopologyReport {
  std::int64_t vertices = 0, triangles = 0;  ///< vertices that a triangle uses
  std::int64_t components = 0;
  std::int64_t euler = 0;           ///< V - E + F
  std::int64_t genus = 0;           ///< sum over components, each closed over its boundary loops; 0 unless manifold
  std::int64_t boundary_loops = 0;  ///< 0 unless manifold
  bool manifold = false;            ///< every edge in one or two triangles, oriented alike; one fan at every vertex

  bool operator==(const TopologyReport&) const = default;
};

/// mesh   any mesh with indices in range.
/// cost   O(triangles log valence); no hash map; 36 bytes a triangle.
TopologyReport report_topology(const IndexedMesh& mesh);
/// The same. errors: cancelled.
Result<TopologyReport> report_topology(const IndexedMesh& mesh, const Progress& progress);

}  // namespace geosis
