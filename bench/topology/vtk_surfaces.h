#pragma once

#include "engine/mesh/indexed_mesh.h"
#include "tests/support/scalar_field.h"

namespace geosis::bench {

/// The level set {f = level} as VTK makes it; vertices of equal position are one.
IndexedMesh vtk_marching_cubes(const test::ScalarField& field, float level);
IndexedMesh vtk_flying_edges(const test::ScalarField& field, float level);

}  // namespace geosis::bench
