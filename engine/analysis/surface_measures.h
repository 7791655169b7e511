#pragma once

#include "engine/mesh/indexed_mesh.h"
#include "engine/volume/geometry.h"

namespace geosis {

/// Area and enclosed volume of the mesh mapped to the world. The volume is meaningful for closed meshes and positive
/// when the mapped triangles look outwards.
struct SurfaceMeasures {
  double area = 0, volume = 0;
};

SurfaceMeasures measure_surface(const IndexedMesh& mesh, const GridGeometry& geometry);

}  // namespace geosis
