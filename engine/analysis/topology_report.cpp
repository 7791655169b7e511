#include "engine/analysis/topology_report.h"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <utility>
#include <vector>

#include "engine/base/stretches.h"
#include "engine/mesh/check.h"
#include "engine/mesh/components.h"
#include "engine/mesh/corner_table.h"

namespace geosis {
namespace {

Error cancelled() {
  return {ErrorCode::cancelled, "reporting the topology was cancelled"};
}

/// Higher ends of all edges, those with the lower end v at ends[first[v]] ... ends[first[v + 1] - 1]; an edge is there
/// once for each of its triangles.
struct EdgeEnds {
  std::vector<std::size_t> first;
  std::vector<std::int32_t> ends;
};

/// Calls visit(lower, higher) for the three edges of every triangle. False: cancelled.
template <class Visit>
bool for_each_edge(const IndexedMesh& mesh, const Progress& progress, const Visit& visit) {
  Stretches stretches(mesh.triangles.size(), progress);
  while (stretches.next()) {
    for (std::size_t t = stretches.begin(); t < stretches.end(); ++t) {
      const auto& [a, b, c] = mesh.triangles[t];
      for (const auto& [lower, higher] : {std::minmax(a, b), std::minmax(b, c), std::minmax(c, a)})
        visit(lower, higher);
    }
  }
  return !stretches.are_cancelled();
}

Result<EdgeEnds> sort_edges(const IndexedMesh& mesh, const Progress& progress) {
  EdgeEnds edges{std::vector<std::size_t>(mesh.positions.size() + 1, 0), {}};
  edges.ends.resize(3 * mesh.triangles.size());
  if (!for_each_edge(mesh, progress, [&](std::int32_t lower, std::int32_t) { ++edges.first[lower]; })) {
    return cancelled();
  }
  std::partial_sum(edges.first.begin(), edges.first.end(), edges.first.begin());
  // Counts have become ends; filling turns each end into a start.
  const auto place = [&](std::int32_t lower, std::int32_t higher) { edges.ends[--edges.first[lower]] = higher; };
  if (!for_each_edge(mesh, progress, place)) return cancelled();
  return edges;
}

Result<std::int64_t> count_edges(const IndexedMesh& mesh, const Progress& progress) {
  auto edges = sort_edges(mesh, progress);
  if (!edges) return std::move(edges).error();
  std::int64_t count = 0;
  Stretches stretches(mesh.positions.size(), progress);
  while (stretches.next()) {
    for (std::size_t v = stretches.begin(); v < stretches.end(); ++v) {
      const auto begin = edges->ends.begin() + static_cast<std::ptrdiff_t>(edges->first[v]);
      const auto end = edges->ends.begin() + static_cast<std::ptrdiff_t>(edges->first[v + 1]);
      std::sort(begin, end);
      count += std::unique(begin, end) - begin;
    }
  }
  if (stretches.are_cancelled()) return cancelled();
  return count;
}

/// What can be counted on any set of triangles.
Result<TopologyReport> report_non_manifold(const IndexedMesh& mesh, const Components& components,
                                           const Progress& progress) {
  const auto edges = count_edges(mesh, progress);
  if (!edges) return edges.error();
  TopologyReport report;
  report.triangles = static_cast<std::int64_t>(mesh.triangles.size());
  report.vertices = std::count_if(components.of_vertex.begin(), components.of_vertex.end(),
                                  [](std::int32_t component) { return component != Components::kUnused; });
  report.components = components.count;
  report.euler = report.vertices - *edges + report.triangles;
  return report;
}

Result<TopologyReport> report_manifold(const Components& components, const CornerTable& table,
                                       const Progress& progress) {
  const auto measured = measure_components(components, table, progress);
  if (!measured) return measured.error();
  TopologyReport report;
  report.manifold = true;
  report.components = components.count;
  for (const ComponentTopology& component : *measured) {
    report.vertices += component.vertices;
    report.triangles += component.triangles;
    report.euler += component.euler();
    report.genus += component.genus();
    report.boundary_loops += component.boundary_loops;
  }
  return report;
}

}  // namespace

Result<TopologyReport> report_topology(const IndexedMesh& mesh, const Progress& progress) {
  const auto components = find_components(mesh, progress);
  if (!components) return components.error();
  const auto table = build_corner_table(mesh, progress);
  const auto fans = table ? check_fans(*table, mesh.positions.size(), progress) : Result<void>(table.error());
  if (fans) return report_manifold(*components, *table, progress);
  if (fans.error().code == ErrorCode::cancelled) return fans.error();
  return report_non_manifold(mesh, *components, progress);
}

TopologyReport report_topology(const IndexedMesh& mesh) {
  return *report_topology(mesh, NoProgress());
}

}  // namespace geosis
