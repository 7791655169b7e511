#include "engine/simplify/working_mesh.h"

#include <algorithm>
#include <array>
#include <utility>

#include "engine/simplify/chunks.h"

namespace geosis {
namespace {

void grow(Box& box, const Box& by) {
  for (int axis = 0; axis < 3; ++axis) {
    box.low[axis] = std::min(box.low[axis], by.low[axis]);
    box.high[axis] = std::max(box.high[axis], by.high[axis]);
  }
}

Box bounds_of(const std::vector<Vec3f>& positions, int threads) {
  if (positions.empty()) return {};
  std::array<Box, kChunks> boxes;
  for_chunks(positions.size(), threads, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
    Box box{positions[0], positions[0]};
    for (std::size_t v = begin; v < end; ++v) grow(box, {positions[v], positions[v]});
    boxes[chunk] = box;
  });
  for (const Box& box : boxes) grow(boxes[0], box);
  return boxes[0];
}

/// The vertices that a triangle uses.
std::vector<std::uint8_t> used_vertices(const WorkingMesh& mesh) {
  std::vector<std::uint8_t> used(mesh.slots(), 0);
  for (const Triangle& triangle : mesh.triangles()) {
    for (const std::int32_t v : triangle) used[v] = 1;
  }
  return used;
}

/// A level of M0 itself, which may have vertices without triangles; later none has.
LodLevel level_of_m0(const WorkingMesh& mesh) {
  const auto used = used_vertices(mesh);
  std::vector<std::int32_t> place(used.size());
  LodLevel level;
  for (std::size_t v = 0; v < used.size(); ++v) {
    if (!used[v]) continue;
    place[v] = static_cast<std::int32_t>(level.origin.size());
    level.mesh.positions.push_back(mesh.position(v));
    level.origin.push_back(static_cast<std::int32_t>(v));
  }
  level.mesh.triangles.reserve(mesh.triangles().size());
  for (const auto& [a, b, c] : mesh.triangles()) level.mesh.triangles.push_back({place[a], place[b], place[c]});
  return level;
}

}  // namespace

WorkingMesh::WorkingMesh(const IndexedMesh& m0, int threads)
    : m0_(&m0),
      segments_{{0, m0.positions.size()}},
      vertex_count_(m0.positions.size()),
      bounds_(bounds_of(m0.positions, threads)) {}

WorkingMesh::WorkingMesh(Buffer<WorkingVertex> vertices, std::vector<Segment> segments, Buffer<Triangle> triangles,
                         const Box& bounds)
    : vertices_(std::move(vertices)),
      segments_(std::move(segments)),
      triangles_(std::move(triangles)),
      bounds_(bounds) {
  for (const auto& [begin, end] : segments_) vertex_count_ += end - begin;
}

WorkingMesh WorkingMesh::clone() const {
  if (m0_) return WorkingMesh(*m0_, 1);
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

LodLevel to_level(const WorkingMesh& mesh, int threads) {
  if (mesh.m0()) return level_of_m0(mesh);
  const std::vector<Segment>& segments = mesh.segments();
  std::vector<std::size_t> first(segments.size() + 1, 0);
  for (std::size_t s = 0; s < segments.size(); ++s) first[s + 1] = first[s] + segments[s].end - segments[s].begin;
  Buffer<std::int32_t> place(mesh.slots());
  LodLevel level;
  level.mesh.positions.resize(mesh.vertices());
  level.origin.resize(mesh.vertices());
  level.mesh.triangles.resize(mesh.triangles().size());
  for_chunks(segments.size(), threads, [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) {
      for (std::size_t v = segments[s].begin, to = first[s]; v < segments[s].end; ++v, ++to) {
        const WorkingVertex vertex = mesh.vertex(v);
        place[v] = static_cast<std::int32_t>(to);
        level.mesh.positions[to] = vertex.position;
        level.origin[to] = vertex.origin;
      }
    }
  });
  for_chunks(mesh.triangles().size(), threads, [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      const auto& [a, b, c] = mesh.triangles()[t];
      level.mesh.triangles[t] = {place[a], place[b], place[c]};
    }
  });
  return level;
}

}  // namespace geosis
