#pragma once

#include <string>
#include <vector>

#include "engine/mesh/components.h"
#include "engine/mesh/indexed_mesh.h"

namespace geosis {

/// Euler characteristic and boundary loops of one component, which no level may change.
struct TopologyOfComponent {
  std::int64_t euler_number = 0, boundary_loops = 0;
  auto operator<=>(const TopologyOfComponent&) const = default;
};

/// Counts of each component; fails the test if the mesh is not manifold.
std::vector<ComponentTopology> topology_of(const IndexedMesh& mesh);

/// The same without the counts, sorted: equal for meshes of the same topology, component by component.
std::vector<TopologyOfComponent> sorted_topology_of(const IndexedMesh& mesh);

/// The first vertex off the lattice or unused, or triangle of zero area (exactly); "none" if there is none.
std::string fault_of_shape(const IndexedMesh& mesh);

/// Mean distance of some 200 of a's vertices from the nearest point of b's surface, in voxels.
double mean_distance(const IndexedMesh& a, const IndexedMesh& b);

}  // namespace geosis
