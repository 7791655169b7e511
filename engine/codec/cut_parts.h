#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/codec/mesh_part.h"

namespace geosis {

/// Where a level is cut: along the order of its triangles, which is spatially coherent already.
struct PartPlan {
  std::vector<std::size_t> first_triangle;  ///< (parts + 1), rising from 0 to m
  std::vector<std::uint32_t> seams;         ///< (n) seam id of each vertex; empty when there is one part

  std::size_t parts() const { return first_triangle.size() - 1; }
};

/// As few parts as hold at most max_part_triangles each, equal in size to within one triangle.
PartPlan plan_parts(const IndexedMesh& mesh, std::int32_t max_part_triangles);

/// Part `part` with the vertices it uses, in the level's order, and what those carry.
///
/// cost   O(triangles of the part + the range of vertex indices that they span).
MeshPart cut_part(const IndexedMesh& mesh, const VertexAttributes& attributes, const PartPlan& plan, std::size_t part);

}  // namespace geosis
