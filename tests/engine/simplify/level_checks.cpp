#include "tests/engine/simplify/level_checks.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "engine/mesh/check.h"
#include "engine/mesh/corner_table.h"

namespace geosis {
namespace {

/// In lattice steps: 64-bit products of these are exact.
Vec3<std::int64_t> steps(Vec3f p) {
  return {std::llround(p.x * kLatticeStepsPerVoxel), std::llround(p.y * kLatticeStepsPerVoxel),
          std::llround(p.z * kLatticeStepsPerVoxel)};
}

bool on_lattice(Vec3f p) {
  const auto s = steps(p);
  return Vec3f{static_cast<float>(s.x), static_cast<float>(s.y), static_cast<float>(s.z)} * kLatticeStep == p;
}

Vec3d closest_on_segment(Vec3d p, Vec3d a, Vec3d b) {
  const Vec3d edge = b - a;
  const double length2 = dot(edge, edge);
  const double t = length2 > 0 ? std::clamp(dot(p - a, edge) / length2, 0.0, 1.0) : 0.0;
  return a + edge * t;
}

double distance2_to_triangle(Vec3d p, Vec3d a, Vec3d b, Vec3d c) {
  const Vec3d normal = cross(b - a, c - a);
  const bool above = dot(cross(b - a, p - a), normal) >= 0 && dot(cross(c - b, p - b), normal) >= 0 &&
                     dot(cross(a - c, p - c), normal) >= 0;
  if (above) {
    const double height = dot(p - a, normal);
    return height * height / dot(normal, normal);
  }
  double best = std::numeric_limits<double>::max();
  for (const Vec3d& q : {closest_on_segment(p, a, b), closest_on_segment(p, b, c), closest_on_segment(p, c, a)}) {
    best = std::min(best, dot(p - q, p - q));
  }
  return best;
}

}  // namespace

std::vector<ComponentTopology> topology_of(const IndexedMesh& mesh) {
  const auto sound = check_manifold(mesh);
  EXPECT_TRUE(sound) << sound.error().message;
  const auto table = build_corner_table(mesh);
  return table ? measure_components(find_components(mesh), *table) : std::vector<ComponentTopology>{};
}

std::vector<TopologyOfComponent> sorted_topology_of(const IndexedMesh& mesh) {
  std::vector<TopologyOfComponent> result;
  for (const ComponentTopology& t : topology_of(mesh)) result.push_back({t.euler(), t.boundary_loops});
  std::sort(result.begin(), result.end());
  return result;
}

std::string fault_of_shape(const IndexedMesh& mesh) {
  std::vector<bool> used(mesh.positions.size(), false);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    used[a] = used[b] = used[c] = true;
    const auto origin = steps(mesh.positions[a]);
    const auto normal = cross(steps(mesh.positions[b]) - origin, steps(mesh.positions[c]) - origin);
    if (normal == Vec3<std::int64_t>{}) return "triangle " + std::to_string(t) + " has zero area";
  }
  for (std::size_t v = 0; v < used.size(); ++v) {
    if (!used[v]) return "vertex " + std::to_string(v) + " is unused";
    if (!on_lattice(mesh.positions[v])) return "vertex " + std::to_string(v) + " is off the lattice";
  }
  return "none";
}

double mean_distance(const IndexedMesh& a, const IndexedMesh& b) {
  const std::size_t step = std::max<std::size_t>(a.positions.size() / 200, 1);
  double sum = 0;
  int samples = 0;
  for (std::size_t v = 0; v < a.positions.size(); v += step, ++samples) {
    const Vec3d p = to_double(a.positions[v]);
    double best = std::numeric_limits<double>::max();
    for (const auto& [u, w, x] : b.triangles) {
      best = std::min(best, distance2_to_triangle(p, to_double(b.positions[u]), to_double(b.positions[w]),
                                                  to_double(b.positions[x])));
    }
    sum += std::sqrt(best);
  }
  return sum / samples;
}

}  // namespace geosis
