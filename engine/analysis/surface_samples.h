#pragma once

#include <cstddef>
#include <vector>

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/base/vec3.h"
#include "engine/mesh/indexed_mesh.h"

namespace geosis {

/// Points on a surface: first some of its vertices, then points spread by area.
struct SurfaceSamples {
  std::vector<Vec3d> points;
  std::size_t vertices = 0;  ///< how many of the points are vertices
};

/// count points, at places that depend on the mesh alone: up to count / 2 vertices, evenly spaced in their order; then
/// one point in each of equal shares of the area, taken along the order of the triangles.
///
/// mesh   at least one triangle; a triangle without area gets no point unless all have none.
SurfaceSamples sample_surface(const IndexedMesh& mesh, std::size_t count);
/// The same. errors: cancelled.
Result<SurfaceSamples> sample_surface(const IndexedMesh& mesh, std::size_t count, const Progress& progress);

}  // namespace geosis
