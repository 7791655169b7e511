#pragma once

#include "engine/base/result.h"
#include "engine/mesh/indexed_mesh.h"

namespace geosis {

/// errors   invalid_argument: a position off the 1/64 lattice or too far out, an index out of range.
Result<void> check_m0(const IndexedMesh& m0, int threads);

/// What is wrong with a mesh that is no manifold.
Error fault_of(const IndexedMesh& m0);

}  // namespace geosis
