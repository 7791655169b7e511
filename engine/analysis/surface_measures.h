#pragma once

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/mesh/indexed_mesh.h"
#include "engine/volume/geometry.h"

namespace geosis {

/// Area and enclosed volume of the mesh mapped to the world, in world units. The volume is meaningful for closed meshes
/// and positive when the mapped triangles look outwards.
struct SurfaceMeasures {
  double area = 0, volume = 0;
};

/// Sums run in double, in the order of the triangles, on positions relative to the mesh's first vertex: an origin
/// thousands of kilometres away costs no digits.
SurfaceMeasures measure_surface(const IndexedMesh& mesh, const GridGeometry& geometry);
/// The same. errors: cancelled.
Result<SurfaceMeasures> measure_surface(const IndexedMesh& mesh, const GridGeometry& geometry,
                                        const Progress& progress);

}  // namespace geosis
