#pragma once

#include <cstdint>

#include "engine/analysis/surface_samples.h"
#include "engine/analysis/triangle_grid.h"
#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/mesh/indexed_mesh.h"

namespace geosis {

struct DistanceOptions {
  std::int64_t samples = 10'000;  ///< points on each of the two surfaces, at least 1
  int threads = 1;
};

/// Two-sided distance between two surfaces, on sample points: from points on a to surface b and from points on b to
/// surface a.
struct SurfaceDistance {
  double mean_voxels = 0;    ///< mean of the two one-sided means over points spread by area; index units
  double max_voxels = 0;     ///< over all points
  std::int64_t samples = 0;  ///< points used, both ways together; 0 = nothing was measured
};

/// One surface, prepared once, from which distances to others are measured.
///
/// Up to half of the points on a surface are its vertices, evenly spaced in their order, for they reach furthest; the
/// others are spread evenly by area, at places that depend on the mesh alone (no random numbers). The distance of each
/// point is exact, and the result is the same for any number of threads.
class ReferenceSurface {
 public:
  /// mesh   at least one triangle; kept by reference.
  /// cost   O(triangles): a grid of cells, 20 bytes a triangle.
  ReferenceSurface(const IndexedMesh& mesh, const DistanceOptions& options, const Progress& progress = NoProgress());

  /// All zero when the other mesh has no triangles. errors: cancelled: this, or the preparation.
  Result<SurfaceDistance> measure(const IndexedMesh& other, const Progress& progress = NoProgress()) const;

 private:
  DistanceOptions options_;
  Result<SurfaceSamples> samples_;
  TriangleGrid grid_;
};

/// Distance between two surfaces, symmetric in a and b; all zero when one of them has no triangles.
SurfaceDistance measure_distance(const IndexedMesh& a, const IndexedMesh& b, const DistanceOptions& options);

}  // namespace geosis
