#pragma once

#include <cstdint>
#include <vector>

#include "engine/mesh/corner_table.h"
#include "engine/mesh/indexed_mesh.h"
#include "engine/mesh/lod_hierarchy.h"
#include "engine/simplify/quadric.h"

namespace geosis {

/// A vertex while levels are made: one cache line.
struct alignas(64) WorkingVertex {
  Vec3f position;
  Quadric quadric;          ///< in the vertex's own frame
  std::int32_t origin = 0;  ///< vertex of M0
  bool on_boundary = false;
  bool locked = false;  ///< for this pass: a triangle leaves the window, or too many triangles meet here
};

struct Box {
  Vec3f low, high;
};

/// The mesh between two passes.
struct WorkingMesh {
  std::vector<WorkingVertex> vertices;
  std::vector<Triangle> triangles;
  Box bounds;          ///< of M0; no vertex leaves it
  float max_cost = 0;  ///< largest cost of an accepted collapse so far
};

/// Vertices with the planes of their triangles and, on boundaries, planes across the surface through the boundary
/// edges, so that rims keep their shape. The table must be that of m0, which must be manifold.
WorkingMesh make_working_mesh(const IndexedMesh& m0, const CornerTable& table);

/// The plain mesh with its origins, without unused vertices.
LodLevel to_level(const WorkingMesh& mesh);

}  // namespace geosis
