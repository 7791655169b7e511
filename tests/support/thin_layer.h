#pragma once

#include <cstdint>

#include "engine/base/vec3.h"
#include "engine/mesh/indexed_mesh.h"
#include "tests/support/scalar_field.h"

namespace geosis::test {

/// One bright plane layer between weaker ones parallel to it, all of which fall by `dip` samples a trace on both
/// lateral axes.
struct ThinLayer {
  GridShape shape = {60, 60, 120};
  double dip = 3;
  double thickness = 2;  ///< samples, down a trace, where it is above kThinLayerLevel
  double noise = 0;      ///< of deviation so much, where the layer is 1 high
  std::uint64_t seed = 1;
};

inline constexpr float kThinLayerLevel = 0.5f;

ScalarField samples_of(const ThinLayer& layer);

/// How a mesh (inline, crossline, sample) that should be the layer's two faces compares with them. Triangles near the
/// box's faces, where the layer is cut, do not count. Weighted by area.
struct LayerFit {
  double normal_degrees = 0;  ///< root mean square angle between triangles and the layer
  double error = 0;           ///< mean distance of triangles' centres from the nearer face, samples down a trace
};
LayerFit fit_of(const ThinLayer& layer, const IndexedMesh& mesh);

}  // namespace geosis::test
