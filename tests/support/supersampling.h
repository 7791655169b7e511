#pragma once

#include "engine/isosurface/extract.h"
#include "tests/support/body_oracle.h"
#include "tests/support/scalar_field.h"

namespace geosis::test {

/// Brute force: every cell cut into refinement^3 voxels, each in the body when f at its centre is; voxels of the body
/// are connected through faces, the rest of space also through edges and corners. Right as soon as the voxels are
/// smaller than the body's thinnest neck, wall and tunnel: compare refinements that agree. `decided` is always true.
///
/// cost     O(cells * refinement^3)
SurfaceTopology supersampled_surface(const ScalarField& field, IsoRange range, BodyMode mode, int refinement);

/// Volume of the body by the same voxels, in cells.
double supersampled_volume(const ScalarField& field, IsoRange range, BodyMode mode, int refinement);

}  // namespace geosis::test
