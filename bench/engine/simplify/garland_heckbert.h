#pragma once

#include "engine/mesh/indexed_mesh.h"

namespace geosis {

/// CGAL's edge collapse with Garland & Heckbert's policies, down to about that share of the triangles.
IndexedMesh garland_heckbert(const IndexedMesh& m0, double ratio);

}  // namespace geosis
