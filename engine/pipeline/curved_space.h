#pragma once

#include <vector>

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/isosurface/labelled_surface.h"
#include "engine/pipeline/reconstruct.h"
#include "engine/volume/geometry.h"

namespace geosis {

/// Whether results go to the world space of a grid that is not affine.
inline bool is_curved_space(const GridGeometry& geometry, const ReconstructOptions& options) {
  return !options.index_space && geometry.affine() == nullptr;
}

/// A surface where a grid that is not affine puts it.
struct CurvedSpace {
  /// From the mesh's coordinates to the world: a shift, and a scale that is the largest power of two not above the
  /// median cell edge of the axis where that is smallest. So the lattice step is at most 1/64 of such an edge.
  AffineGeometry space;
  std::vector<Vec3f> places;  ///< (n) where each vertex lies among the samples, in index coordinates
};

/// Moves M0 from index coordinates to the world, on a lattice of its own; from then on its coordinates are world
/// positions from an origin, divided by the scale. Vertices that fall together are merged where topology allows; bodies
/// are measured and numbered anew, and the largest that the options ask for are kept.
///
/// surface  its triangles look outwards in the world already. Not empty.
/// errors   limit_exceeded: the surface is more than 131,071 of these units long.  cancelled.
Result<CurvedSpace> bend_surface(const GridGeometry& geometry, GridShape shape, const ReconstructOptions& options,
                                 const Progress& progress, LabelledSurface& surface);

}  // namespace geosis
