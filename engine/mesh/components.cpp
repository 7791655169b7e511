#include "engine/mesh/components.h"

#include "engine/base/disjoint_sets.h"

namespace geosis {
namespace {

/// Each boundary loop once, at one of its vertices.
void count_boundary_loops(const Components& components, const CornerTable& table,
                          std::vector<ComponentTopology>& result) {
  std::vector<bool> seen(table.vertex.size(), false);
  for (std::int32_t c = 0; c < table.corners(); ++c) {
    if (table.opposite[c] != CornerTable::kNoCorner || seen[c]) continue;
    ++result[components.of_vertex[table.vertex[c]]].boundary_loops;
    for (std::int32_t at = c; !seen[at]; at = table.next_on_boundary(at)) seen[at] = true;
  }
}

}  // namespace

Components find_components(const IndexedMesh& mesh) {
  const std::size_t vertices = mesh.positions.size();
  DisjointSets sets;
  sets.reset(static_cast<std::int32_t>(vertices));
  Components result{0, std::vector<std::int32_t>(vertices, Components::kUnused)};
  constexpr std::int32_t kUsed = 0;  // stands until the vertex gets its label
  for (const auto& [a, b, c] : mesh.triangles) {
    sets.unite(a, b);
    sets.unite(b, c);
    result.of_vertex[a] = result.of_vertex[b] = result.of_vertex[c] = kUsed;
  }
  for (std::size_t v = 0; v < vertices; ++v) {
    if (result.of_vertex[v] == Components::kUnused) continue;
    const std::int32_t root = sets.root(static_cast<std::int32_t>(v));
    result.of_vertex[v] = static_cast<std::size_t>(root) == v ? result.count++ : result.of_vertex[root];
  }
  return result;
}

std::vector<ComponentTopology> measure_components(const Components& components, const CornerTable& table) {
  std::vector<ComponentTopology> result(components.count);
  for (const std::int32_t component : components.of_vertex) {
    if (component != Components::kUnused) ++result[component].vertices;
  }
  for (std::int32_t c = 0; c < table.corners(); ++c) {
    ComponentTopology& topology = result[components.of_vertex[table.vertex[c]]];
    topology.triangles += c % 3 == 0;
    topology.edges += table.opposite[c] < c;  // the higher of two corners counts the edge, as does a boundary corner
  }
  count_boundary_loops(components, table, result);
  return result;
}

}  // namespace geosis
