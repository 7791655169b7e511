#pragma once

#include <cstdint>

#include "engine/base/vec3.h"
#include "engine/mesh/indexed_mesh.h"

namespace geosis {

struct DistanceOptions {
  std::int64_t samples = 10'000;  ///< points on each of the two surfaces
  int threads = 1;
};

/// Two-sided distance between two surfaces, on sample points: mean and maximum of the distances from points on a to
/// surface b and from points on b to surface a.
struct SurfaceDistance {
  double mean_voxels = 0, max_voxels = 0;  ///< index units
  std::int64_t samples = 0;                ///< points used, both ways together
};

/// Points are spread over each surface by area, at places that depend on the mesh alone (no random numbers), and the
/// vertices of b come first. The same result for any number of threads.
SurfaceDistance measure_distance(const IndexedMesh& a, const IndexedMesh& b, const DistanceOptions& options);

}  // namespace geosis
