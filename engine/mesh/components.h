#pragma once

#include <cstdint>
#include <vector>

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/mesh/corner_table.h"
#include "engine/mesh/indexed_mesh.h"

namespace geosis {

/// Connected components of a mesh; triangles that share a vertex are connected.
struct Components {
  static constexpr std::int32_t kUnused = -1;

  std::int32_t count = 0;
  std::vector<std::int32_t> of_vertex;  ///< (n) component, numbered by lowest vertex index; kUnused without triangle
};

/// mesh     any mesh with indices in range; it need not be manifold.
/// cost     O(triangles), near enough; 8 bytes a vertex.
Components find_components(const IndexedMesh& mesh);
/// The same. errors: cancelled.
Result<Components> find_components(const IndexedMesh& mesh, const Progress& progress);

/// Counts of one component (or of a whole mesh, by adding them up).
struct ComponentTopology {
  std::int64_t vertices = 0, edges = 0, triangles = 0;
  std::int64_t boundary_loops = 0;

  std::int64_t euler() const { return vertices - edges + triangles; }
  /// Handles of the component once each boundary loop is closed with a disc.
  std::int64_t genus() const { return (2 - boundary_loops - euler()) / 2; }

  auto operator<=>(const ComponentTopology&) const = default;
};

/// One entry a component. The table must be that of the mesh.
std::vector<ComponentTopology> measure_components(const Components& components, const CornerTable& table);
/// The same. errors: cancelled.
Result<std::vector<ComponentTopology>> measure_components(const Components& components, const CornerTable& table,
                                                          const Progress& progress);

}  // namespace geosis
