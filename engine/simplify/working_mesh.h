#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "engine/mesh/indexed_mesh.h"
#include "engine/mesh/lod_hierarchy.h"
#include "engine/simplify/buffer.h"
#include "engine/simplify/working_vertex.h"

namespace geosis {

struct Box {
  Vec3f low, high;
};

/// Vertices begin ... end - 1.
struct Segment {
  std::size_t begin = 0, end = 0;
};

/// The mesh between two passes. Windows leave gaps behind their remaining vertices, so only the segments hold any.
///
/// Before the first pass there are no records yet: vertices and triangles are M0's.
class WorkingMesh {
 public:
  explicit WorkingMesh(const IndexedMesh& m0, int threads = 1);  ///< which must stay until the first pass is over
  WorkingMesh(Buffer<WorkingVertex> vertices, std::vector<Segment> segments, Buffer<Triangle> triangles,
              const Box& bounds);

  WorkingMesh clone() const;

  const IndexedMesh* m0() const { return m0_; }  ///< null after the first pass
  std::size_t slots() const { return m0_ ? m0_->positions.size() : vertices_.size(); }
  std::size_t vertices() const { return vertex_count_; }
  const std::vector<Segment>& segments() const { return segments_; }
  std::span<const Triangle> triangles() const {
    return m0_ ? std::span(m0_->triangles) : std::span(triangles_.begin(), triangles_.size());
  }
  const Box& bounds() const { return bounds_; }  ///< of M0; no vertex leaves it

  Vec3f position(std::size_t v) const { return m0_ ? m0_->positions[v] : vertices_[v].position; }
  WorkingVertex vertex(std::size_t v) const {
    return m0_ ? make_vertex(m0_->positions[v], static_cast<std::int32_t>(v)) : vertices_[v];
  }

 private:
  const IndexedMesh* m0_ = nullptr;
  Buffer<WorkingVertex> vertices_;
  std::vector<Segment> segments_;
  Buffer<Triangle> triangles_;
  std::size_t vertex_count_ = 0;
  Box bounds_;
};

/// The mesh without the vertices for whose vertex of M0 `goes` holds, and without their triangles.
///
/// mesh   after its first pass.
/// goes   holds for whole components or not at all.
WorkingMesh without(const WorkingMesh& mesh, const std::function<bool(std::int32_t origin)>& goes);

/// The plain mesh with its origins, without unused vertices.
LodLevel to_level(const WorkingMesh& mesh, int threads);

}  // namespace geosis
