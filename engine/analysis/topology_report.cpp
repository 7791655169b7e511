#include "engine/analysis/topology_report.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "engine/mesh/check.h"
#include "engine/mesh/components.h"
#include "engine/mesh/corner_table.h"

namespace geosis {
namespace {

std::int64_t count_edges(const IndexedMesh& mesh) {
  std::vector<std::pair<std::int32_t, std::int32_t>> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (const auto& [a, b, c] : mesh.triangles) {
    for (const auto& edge : {std::minmax(a, b), std::minmax(b, c), std::minmax(c, a)}) edges.emplace_back(edge);
  }
  std::sort(edges.begin(), edges.end());
  return std::unique(edges.begin(), edges.end()) - edges.begin();
}

/// What can be counted on any set of triangles.
TopologyReport report_non_manifold(const IndexedMesh& mesh, const Components& components) {
  TopologyReport report;
  report.triangles = static_cast<std::int64_t>(mesh.triangles.size());
  report.vertices = std::count_if(components.of_vertex.begin(), components.of_vertex.end(),
                                  [](std::int32_t component) { return component != Components::kUnused; });
  report.components = components.count;
  report.euler = report.vertices - count_edges(mesh) + report.triangles;
  return report;
}

TopologyReport report_manifold(const Components& components, const CornerTable& table) {
  TopologyReport report;
  report.manifold = true;
  report.components = components.count;
  for (const ComponentTopology& component : measure_components(components, table)) {
    report.vertices += component.vertices;
    report.triangles += component.triangles;
    report.euler += component.euler();
    report.genus += component.genus();
    report.boundary_loops += component.boundary_loops;
  }
  return report;
}

}  // namespace

TopologyReport report_topology(const IndexedMesh& mesh) {
  const Components components = find_components(mesh);
  const auto table = build_corner_table(mesh);
  if (!table || !check_fans(*table, mesh.positions.size())) return report_non_manifold(mesh, components);
  return report_manifold(components, *table);
}

}  // namespace geosis
