#include "tests/support/mesh_checks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <ostream>
#include <tuple>
#include <vector>

#include "engine/base/vec3.h"
#include "tests/support/union_find.h"

namespace geosis::test {
namespace {

// One side of one triangle: the undirected edge, and which way the triangle runs along it.
struct Side {
  std::int32_t low, high;
  std::int32_t triangle;
  bool rises;

  bool same_edge(const Side& other) const { return low == other.low && high == other.high; }
};

std::vector<Triangle> sound_triangles(const IndexedMesh& mesh) {
  const auto count = static_cast<std::int32_t>(mesh.positions.size());
  std::vector<Triangle> sound;
  for (const Triangle& t : mesh.triangles) {
    const bool in_range = std::all_of(t.begin(), t.end(), [count](std::int32_t v) { return v >= 0 && v < count; });
    if (in_range && t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) sound.push_back(t);
  }
  return sound;
}

std::vector<Side> sorted_sides(const std::vector<Triangle>& triangles) {
  std::vector<Side> sides;
  sides.reserve(triangles.size() * 3);
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (int s = 0; s < 3; ++s) {
      const std::int32_t a = triangles[t][s], b = triangles[t][(s + 1) % 3];
      sides.push_back({std::min(a, b), std::max(a, b), static_cast<std::int32_t>(t), a < b});
    }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return std::tie(a.low, a.high, a.triangle) < std::tie(b.low, b.high, b.triangle);
  });
  return sides;
}

// Calls visit(first, count) for each run of sides of the same edge.
template <class Visit>
void for_each_edge(const std::vector<Side>& sides, Visit&& visit) {
  for (std::size_t first = 0, last = 0; first < sides.size(); first = last) {
    while (last < sides.size() && sides[last].same_edge(sides[first])) ++last;
    visit(&sides[first], last - first);
  }
}

void count_edges(const std::vector<Side>& sides, MeshCensus& census) {
  for_each_edge(sides, [&](const Side* side, std::size_t count) {
    ++census.edges;
    if (count == 1) ++census.border_edges;
    if (count > 2) ++census.crowded_edges;
    if (count == 2 && side[0].rises == side[1].rises) ++census.disoriented_edges;
  });
}

std::int32_t corner_at(const std::vector<Triangle>& triangles, std::int32_t triangle, std::int32_t vertex) {
  const Triangle& t = triangles[triangle];
  return triangle * 3 + (t[0] == vertex ? 0 : t[1] == vertex ? 1 : 2);
}

// Corners joined around their vertex, wherever two triangles share an edge: one set per fan.
void count_vertices(const std::vector<Triangle>& triangles, const std::vector<Side>& sides, std::size_t vertices,
                    MeshCensus& census) {
  UnionFind fans(static_cast<std::int64_t>(triangles.size()) * 3), bodies(static_cast<std::int64_t>(triangles.size()));
  for_each_edge(sides, [&](const Side* side, std::size_t count) {
    for (std::size_t other = 1; other < count; ++other) {
      bodies.unite(side[0].triangle, side[other].triangle);
      for (const std::int32_t v : {side[0].low, side[0].high})
        fans.unite(corner_at(triangles, side[0].triangle, v), corner_at(triangles, side[other].triangle, v));
    }
  });
  std::vector<std::int32_t> fans_at(vertices);
  for (std::int32_t corner = 0; corner < static_cast<std::int32_t>(triangles.size()) * 3; ++corner)
    if (fans.find(corner) == corner) ++fans_at[triangles[corner / 3][corner % 3]];
  for (const std::int32_t count : fans_at) {
    census.vertices += count > 0;
    census.unused_vertices += count == 0;
    census.pinched_vertices += count > 1;
  }
  census.components = bodies.count();
}

// Six times the volume under one triangle, seen from the origin.
double wedge(const IndexedMesh& mesh, const Triangle& t) {
  const Vec3d a = to_double(mesh.positions[t[0]]), b = to_double(mesh.positions[t[1]]);
  return dot(a, cross(b, to_double(mesh.positions[t[2]])));
}

std::vector<std::int32_t> vertices_by_position(const IndexedMesh& mesh) {
  std::vector<std::int32_t> order(mesh.positions.size());
  for (std::size_t v = 0; v < order.size(); ++v) order[v] = static_cast<std::int32_t>(v);
  const auto key = [&](std::int32_t v) {
    const Vec3f p = mesh.positions[v];
    return std::tuple(p.x, p.y, p.z, v);
  };
  std::sort(order.begin(), order.end(), [&](std::int32_t a, std::int32_t b) { return key(a) < key(b); });
  return order;
}

bool on_lattice(Vec3f p) {
  for (int axis = 0; axis < 3; ++axis)
    if (const float steps = p[axis] * kLatticeStepsPerVoxel; steps != std::floor(steps)) return false;
  return true;
}

}  // namespace

MeshCensus census(const IndexedMesh& mesh) {
  MeshCensus census;
  const std::vector<Triangle> triangles = sound_triangles(mesh);
  const std::vector<Side> sides = sorted_sides(triangles);
  census.triangles = static_cast<std::int64_t>(triangles.size());
  census.bad_indices = static_cast<std::int64_t>(mesh.triangles.size() - triangles.size());
  count_edges(sides, census);
  count_vertices(triangles, sides, mesh.positions.size(), census);
  for (const Triangle& t : triangles) census.volume += wedge(mesh, t);
  census.volume /= 6;  // once: the sum over a lattice is exact
  const std::vector<std::int32_t> order = vertices_by_position(mesh);
  for (std::size_t v = 1; v < order.size(); ++v)
    census.repeated_positions += mesh.positions[order[v]] == mesh.positions[order[v - 1]];
  for (const Vec3f p : mesh.positions) census.off_lattice += !on_lattice(p);
  return census;
}

IndexedMesh welded(const IndexedMesh& mesh) {
  IndexedMesh result;
  std::vector<std::int32_t> vertex(mesh.positions.size());
  for (const std::int32_t v : vertices_by_position(mesh)) {
    if (result.positions.empty() || result.positions.back() != mesh.positions[v])
      result.positions.push_back(mesh.positions[v]);
    vertex[v] = static_cast<std::int32_t>(result.positions.size()) - 1;
  }
  for (const Triangle& t : mesh.triangles) result.triangles.push_back({vertex[t[0]], vertex[t[1]], vertex[t[2]]});
  return result;
}

std::ostream& operator<<(std::ostream& out, const MeshCensus& c) {
  return out << c.vertices << " vertices, " << c.edges << " edges, " << c.triangles << " triangles, euler " << c.euler()
             << ", components " << c.components << ", volume " << c.volume << "; bad indices " << c.bad_indices
             << ", unused vertices " << c.unused_vertices << ", border edges " << c.border_edges << ", crowded edges "
             << c.crowded_edges << ", disoriented edges " << c.disoriented_edges << ", pinched vertices "
             << c.pinched_vertices << ", repeated positions " << c.repeated_positions << ", off lattice "
             << c.off_lattice;
}

}  // namespace geosis::test
