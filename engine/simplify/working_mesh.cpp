#include "engine/simplify/working_mesh.h"

#include <algorithm>
#include <utility>

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

}  // namespace

WorkingMesh::WorkingMesh(const IndexedMesh& m0)
    : m0_(&m0),
      segments_{{0, m0.positions.size()}},
      vertex_count_(m0.positions.size()),
      bounds_(bounds_of(m0.positions)) {}

WorkingMesh::WorkingMesh(Buffer<WorkingVertex> vertices, std::vector<Segment> segments, Buffer<Triangle> triangles,
                         const Box& bounds)
    : vertices_(std::move(vertices)),
      segments_(std::move(segments)),
      triangles_(std::move(triangles)),
      bounds_(bounds) {
  for (const auto& [begin, end] : segments_) vertex_count_ += end - begin;
}

WorkingMesh WorkingMesh::clone() const {
  if (m0_) return WorkingMesh(*m0_);
  return WorkingMesh(vertices_.clone(), segments_, triangles_.clone(), bounds_);
}

WorkingMesh without(const WorkingMesh& mesh, const std::function<bool(std::int32_t origin)>& goes) {
  constexpr std::int32_t kGone = -1;
  std::vector<std::int32_t> place(mesh.slots(), kGone);
  Buffer<WorkingVertex> vertices(mesh.vertices());
  std::size_t count = 0;
  for (const auto& [begin, end] : mesh.segments()) {
    for (std::size_t v = begin; v < end; ++v) {
      const WorkingVertex vertex = mesh.vertex(v);
      if (goes(vertex.origin)) continue;
      place[v] = static_cast<std::int32_t>(count);
      vertices[count++] = vertex;
    }
  }
  const auto stays = [&](const Triangle& t) { return place[t[0]] != kGone; };
  Buffer<Triangle> triangles(
      static_cast<std::size_t>(std::count_if(mesh.triangles().begin(), mesh.triangles().end(), stays)));
  Triangle* out = triangles.data();
  for (const Triangle& t : mesh.triangles()) {
    if (stays(t)) *out++ = {place[t[0]], place[t[1]], place[t[2]]};
  }
  return WorkingMesh(std::move(vertices), {{0, count}}, std::move(triangles), mesh.bounds());
}

LodLevel to_level(const WorkingMesh& mesh) {
  constexpr std::int32_t kUnused = -1;
  std::vector<std::int32_t> place(mesh.slots(), kUnused);
  for (const Triangle& triangle : mesh.triangles()) {
    for (const std::int32_t v : triangle) place[v] = 0;
  }
  LodLevel level;
  for (const auto& [begin, end] : mesh.segments()) {
    for (std::size_t v = begin; v < end; ++v) {
      if (place[v] == kUnused) continue;
      place[v] = static_cast<std::int32_t>(level.origin.size());
      const WorkingVertex vertex = mesh.vertex(v);
      level.mesh.positions.push_back(vertex.position);
      level.origin.push_back(vertex.origin);
    }
  }
  level.mesh.triangles.reserve(mesh.triangles().size());
  for (const auto& [a, b, c] : mesh.triangles()) level.mesh.triangles.push_back({place[a], place[b], place[c]});
  return level;
}

}  // namespace geosis
