#pragma once

#include <vector>

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/base/vec3.h"
#include "engine/mesh/indexed_mesh.h"
#include "engine/volume/bricks.h"

namespace geosis {

/// Unit normals of a level's vertices in index coordinates, out of the body.
///
/// They are directions of the field's gradient, by central differences over two nodes of trilinear values: smoother
/// than the triangles. Where the surface does not follow the field (caps, contacts, next to missing samples, far from
/// the level set after simplification) it is the mean direction of the triangles, weighted by area: where the two
/// differ by more than 37 degrees, or the gradient is not known.
///
/// samples   those that the mesh was extracted from.
/// first     where their node (0, 0, 0) lies in the mesh's coordinates.
/// mirrored  the triangles look outwards in a mirrored space, into the body in index coordinates.
/// errors    malformed_input: a damaged brick.  cancelled.
Result<std::vector<Vec3f>> normals_of(const IndexedMesh& mesh, const BrickedVolume& samples, GridIndex first,
                                      bool mirrored, int threads, const Progress& progress);

/// Unit normals that are the mean direction of the triangles alone, which look out of the body.
std::vector<Vec3f> normals_of_triangles(const IndexedMesh& mesh);

}  // namespace geosis
