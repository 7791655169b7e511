#include "engine/simplify/working_mesh.h"

#include <algorithm>
#include <cmath>

namespace geosis {
namespace {

Box bounds_of(const std::vector<Vec3f>& positions) {
  if (positions.empty()) return {};
  Box box{positions[0], positions[0]};
  for (const Vec3f& p : positions) {
    for (int axis = 0; axis < 3; ++axis) {
      box.low[axis] = std::min(box.low[axis], p[axis]);
      box.high[axis] = std::max(box.high[axis], p[axis]);
    }
  }
  return box;
}

/// The triangle's plane, weighted by its area, at its three vertices.
void add_triangle_plane(WorkingVertex& a, WorkingVertex& b, WorkingVertex& c) {
  const Vec3f normal = cross(b.position - a.position, c.position - a.position);
  const float twice_area = norm(normal);
  if (twice_area == 0) return;
  for (WorkingVertex* v : {&a, &b, &c}) add_plane(v->quadric, normal, 0.5f / twice_area);
}

/// The plane through the edge a-b at a right angle to its triangle's, weighted by the edge's squared length.
void add_boundary_plane(WorkingVertex& a, WorkingVertex& b, Vec3f apex) {
  const Vec3f edge = b.position - a.position;
  const Vec3f side = apex - a.position;
  const float length2 = dot(edge, edge);
  if (length2 == 0) return;
  const Vec3f across = side - edge * (dot(side, edge) / length2);
  const float across2 = dot(across, across);
  if (across2 == 0) return;
  for (WorkingVertex* v : {&a, &b}) add_plane(v->quadric, across, length2 / across2);
}

}  // namespace

WorkingMesh make_working_mesh(const IndexedMesh& m0, const CornerTable& table) {
  WorkingMesh mesh{std::vector<WorkingVertex>(m0.positions.size()), m0.triangles, bounds_of(m0.positions)};
  for (std::size_t v = 0; v < m0.positions.size(); ++v) {
    mesh.vertices[v].position = m0.positions[v];
    mesh.vertices[v].origin = static_cast<std::int32_t>(v);
  }
  for (const auto& [a, b, c] : mesh.triangles) {
    add_triangle_plane(mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]);
  }
  for (std::int32_t c = 0; c < table.corners(); ++c) {
    if (table.opposite[c] != CornerTable::kNoCorner) continue;
    WorkingVertex& a = mesh.vertices[table.vertex[CornerTable::next(c)]];
    WorkingVertex& b = mesh.vertices[table.vertex[CornerTable::previous(c)]];
    a.on_boundary = b.on_boundary = true;
    add_boundary_plane(a, b, m0.positions[table.vertex[c]]);
  }
  return mesh;
}

LodLevel to_level(const WorkingMesh& mesh) {
  constexpr std::int32_t kUnused = -1;
  std::vector<std::int32_t> place(mesh.vertices.size(), kUnused);
  for (const Triangle& triangle : mesh.triangles) {
    for (const std::int32_t v : triangle) place[v] = 0;
  }
  LodLevel level;
  for (std::size_t v = 0; v < place.size(); ++v) {
    if (place[v] == kUnused) continue;
    place[v] = static_cast<std::int32_t>(level.origin.size());
    level.mesh.positions.push_back(mesh.vertices[v].position);
    level.origin.push_back(mesh.vertices[v].origin);
  }
  level.mesh.triangles.reserve(mesh.triangles.size());
  for (const auto& [a, b, c] : mesh.triangles) level.mesh.triangles.push_back({place[a], place[b], place[c]});
  return level;
}

}  // namespace geosis
