#include "engine/mesh/components.h"

#include <utility>

#include "engine/base/disjoint_sets.h"
#include "engine/base/stretches.h"

namespace geosis {
namespace {

Error cancelled() {
  return {ErrorCode::cancelled, "counting the components of a mesh was cancelled"};
}

/// Each boundary loop once, at one of its vertices. False: cancelled.
bool count_boundary_loops(const Components& components, const CornerTable& table, const Progress& progress,
                          std::vector<ComponentTopology>& result) {
  std::vector<bool> seen(table.vertex.size(), false);
  Stretches stretches(table.vertex.size(), progress);
  while (stretches.next()) {
    for (std::size_t c = stretches.begin(); c < stretches.end(); ++c) {
      if (table.opposite[c] != CornerTable::kNoCorner || seen[c]) continue;
      ++result[components.of_vertex[table.vertex[c]]].boundary_loops;
      for (auto at = static_cast<std::int32_t>(c); !seen[at]; at = table.next_on_boundary(at)) seen[at] = true;
    }
  }
  return !stretches.are_cancelled();
}

}  // namespace

Result<Components> find_components(const IndexedMesh& mesh, const Progress& progress) {
  const std::size_t vertices = mesh.positions.size();
  DisjointSets sets;
  sets.reset(static_cast<std::int32_t>(vertices));
  Components result{0, std::vector<std::int32_t>(vertices, Components::kUnused)};
  constexpr std::int32_t kUsed = 0;  // stands until the vertex gets its label
  Stretches triangles(mesh.triangles.size(), progress);
  while (triangles.next()) {
    for (std::size_t t = triangles.begin(); t < triangles.end(); ++t) {
      const auto& [a, b, c] = mesh.triangles[t];
      sets.unite(a, b);
      sets.unite(b, c);
      result.of_vertex[a] = result.of_vertex[b] = result.of_vertex[c] = kUsed;
    }
  }
  if (triangles.are_cancelled()) return cancelled();
  Stretches labels(vertices, progress);
  while (labels.next()) {
    for (std::size_t v = labels.begin(); v < labels.end(); ++v) {
      if (result.of_vertex[v] == Components::kUnused) continue;
      const std::int32_t root = sets.root(static_cast<std::int32_t>(v));
      result.of_vertex[v] = static_cast<std::size_t>(root) == v ? result.count++ : result.of_vertex[root];
    }
  }
  if (labels.are_cancelled()) return cancelled();
  return result;
}

Components find_components(const IndexedMesh& mesh) {
  return *find_components(mesh, NoProgress());
}

Result<std::vector<ComponentTopology>> measure_components(const Components& components, const CornerTable& table,
                                                          const Progress& progress) {
  std::vector<ComponentTopology> result(components.count);
  for (const std::int32_t component : components.of_vertex) {
    if (component != Components::kUnused) ++result[component].vertices;
  }
  Stretches corners(table.vertex.size(), progress);
  while (corners.next()) {
    for (std::size_t at = corners.begin(); at < corners.end(); ++at) {
      const auto c = static_cast<std::int32_t>(at);
      ComponentTopology& topology = result[components.of_vertex[table.vertex[c]]];
      topology.triangles += c % 3 == 0;
      topology.edges += table.opposite[c] < c;  // the higher of two corners counts the edge, as does a boundary corner
    }
  }
  if (corners.are_cancelled() || !count_boundary_loops(components, table, progress, result)) return cancelled();
  return result;
}

std::vector<ComponentTopology> measure_components(const Components& components, const CornerTable& table) {
  return *measure_components(components, table, NoProgress());
}

}  // namespace geosis
