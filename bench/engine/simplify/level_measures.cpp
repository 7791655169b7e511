#include "bench/engine/simplify/level_measures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "engine/analysis/self_intersections.h"
#include "engine/base/parallel.h"
#include "engine/mesh/check.h"
#include "engine/mesh/components.h"
#include "engine/mesh/corner_table.h"

namespace geosis {
namespace {

constexpr int kThreads = 2;
constexpr std::size_t kSamples = 100'000;
constexpr double kRimStep = 0.25;  // voxels between points on boundary curves

double volume_of(const IndexedMesh& mesh) {
  double six = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    six += dot(to_double(mesh.positions[a]), cross(to_double(mesh.positions[b]), to_double(mesh.positions[c])));
  }
  return six / 6;
}

/// Of the points from `counted` on; the largest of all.
DistanceSpread spread(const std::vector<Vec3d>& points, std::size_t counted, const TriangleGrid& to) {
  constexpr std::size_t kChunk = 256;
  std::vector<double> distances(points.size());
  parallel_for((points.size() + kChunk - 1) / kChunk, kThreads, [&](std::size_t chunk) {
    NearestTriangle nearest;
    for (std::size_t p = chunk * kChunk; p < std::min(points.size(), (chunk + 1) * kChunk); ++p) {
      nearest = to.find_nearest(points[p], nearest.triangle);
      distances[p] = std::sqrt(nearest.squared_distance);
    }
  });
  DistanceSpread result;
  for (const double distance : distances) result.max = std::max(result.max, distance);
  distances.erase(distances.begin(), distances.begin() + static_cast<std::ptrdiff_t>(counted));
  std::sort(distances.begin(), distances.end());
  for (const double distance : distances) result.mean += distance / static_cast<double>(distances.size());
  result.p99 = distances[(distances.size() - 1) * 99 / 100];
  return result;
}

IndexedMesh boundary_edges(const IndexedMesh& mesh) {
  IndexedMesh edges{mesh.positions, {}};
  const auto table = build_corner_table(mesh);
  if (!table) return edges;
  for (std::int32_t c = 0; c < table->corners(); ++c) {
    if (table->opposite[c] != CornerTable::kNoCorner) continue;
    const std::int32_t a = table->vertex[CornerTable::next(c)], b = table->vertex[CornerTable::previous(c)];
    edges.triangles.push_back({a, b, b});
  }
  return edges;
}

std::vector<Vec3d> points_along(const IndexedMesh& edges) {
  std::vector<Vec3d> points;
  for (const auto& [a, b, unused] : edges.triangles) {
    const Vec3d from = to_double(edges.positions[a]), along = to_double(edges.positions[b]) - from;
    const int steps = std::max(1, static_cast<int>(std::ceil(norm(along) / kRimStep)));
    for (int step = 0; step < steps; ++step) points.push_back(from + along * (static_cast<double>(step) / steps));
  }
  return points;
}

/// How many components there are of each kind.
using Kinds = std::map<std::array<std::int64_t, 2>, std::int64_t>;  // of genus and boundary loops

}  // namespace

struct MeasuredAgainst::Topology {
  ComponentTopology all;
  std::int64_t components = 0, genus = 0;
  Kinds kinds;
  std::string fault;  // of a mesh that is no oriented manifold
};

MeasuredAgainst::Topology MeasuredAgainst::topology_of(const IndexedMesh& mesh) {
  Topology topology;
  const Components components = find_components(mesh);
  topology.components = components.count;
  const auto table = build_corner_table(mesh);
  if (!table) {
    topology.fault = table.error().message;
    return topology;
  }
  if (auto fans = check_fans(*table, mesh.positions.size()); !fans) topology.fault = fans.error().message;
  if (!topology.fault.empty()) return topology;
  for (const ComponentTopology& component : measure_components(components, *table)) {
    topology.all.vertices += component.vertices;
    topology.all.edges += component.edges;
    topology.all.triangles += component.triangles;
    topology.all.boundary_loops += component.boundary_loops;
    topology.genus += component.genus();
    ++topology.kinds[{component.genus(), component.boundary_loops}];
  }
  return topology;
}

std::string MeasuredAgainst::difference(const Topology& level) const {
  if (!level.fault.empty()) return "no manifold: " + level.fault;
  if (level.kinds == topology_->kinds) return "kept";
  if (level.components != topology_->components) {
    return std::to_string(level.components) + " of " + std::to_string(topology_->components) + " components";
  }
  return "other components: genus " + std::to_string(level.genus) + " for " + std::to_string(topology_->genus) +
         ", loops " + std::to_string(level.all.boundary_loops) + " for " +
         std::to_string(topology_->all.boundary_loops);
}

MeasuredAgainst::MeasuredAgainst(const BenchMesh& mesh)
    : mesh_(mesh),
      topology_(std::make_shared<Topology>(topology_of(mesh.m0))),
      samples_(sample_surface(mesh.m0, kSamples)),
      grid_(mesh.m0),
      rim_(boundary_edges(mesh.m0)),
      rim_samples_(points_along(rim_)),
      volume_(volume_of(mesh.m0)) {
  if (!rim_samples_.empty()) rim_grid_ = std::make_unique<TriangleGrid>(rim_);
}

LevelMeasures MeasuredAgainst::measure(const IndexedMesh& level, std::span<const std::int32_t> origin,
                                       bool pairs) const {
  LevelMeasures measures;
  const Topology topology = topology_of(level);
  measures.triangles = static_cast<std::int64_t>(level.triangles.size());
  measures.components = topology.components;
  measures.euler = topology.all.euler();
  measures.genus = topology.genus;
  measures.boundary_loops = topology.all.boundary_loops;
  measures.topology = difference(topology);
  const SurfaceSamples back = sample_surface(level, kSamples);
  measures.distance = {spread(samples_.points, samples_.vertices, TriangleGrid(level)),
                       spread(back.points, back.vertices, grid_)};
  if (rim_grid_) {
    const IndexedMesh rim = boundary_edges(level);
    if (!rim.triangles.empty()) {
      measures.rim = TwoWays{spread(rim_samples_, 0, TriangleGrid(rim)), spread(points_along(rim), 0, *rim_grid_)};
    }
  }
  measures.volume_drift = (volume_of(level) - volume_) / volume_;
  if (pairs) measures.pairs = find_pairs(level, origin);
  return measures;
}

IntersectingPairs MeasuredAgainst::find_pairs(const IndexedMesh& level, std::span<const std::int32_t> origin) const {
  const Components components = find_components(level);
  const auto sheet = [&](std::int32_t t) {
    const auto v = static_cast<std::size_t>(level.triangles[t][0]);
    return mesh_.sheet.empty() ? std::uint8_t{0} : mesh_.sheet[origin.empty() ? v : origin[v]];
  };
  const auto component = [&](std::int32_t t) { return components.of_vertex[level.triangles[t][0]]; };
  IntersectingPairs pairs;
  for (const auto& [a, b] : find_intersecting_pairs(level, kThreads)) {
    if (sheet(a) != sheet(b)) {
      ++pairs.between_sheets;
    } else if (component(a) != component(b)) {
      ++pairs.between_components;
    } else {
      ++pairs.within_a_sheet;
    }
  }
  return pairs;
}

}  // namespace geosis
