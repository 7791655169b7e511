#pragma once

#include <cstdint>

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/mesh/indexed_mesh.h"
#include "engine/volume/bricks.h"
#include "engine/volume/grid.h"

namespace geosis {

/// The body is {low <= f <= high}. Either end may be infinite; low == high is a slab at least one lattice step thin.
struct IsoRange {
  float low = 0, high = 0;
};

enum class BodyMode {
  exact,    ///< f trilinear in each cell; the surface is the union of {f = low} and {f = high}
  sampled,  ///< the paper's g = (f - low)(high - f), trilinear in each cell; the surface is {g = 0}
};

struct ExtractOptions {
  BodyMode mode = BodyMode::exact;
  bool cap = true;        ///< close the body on the region's faces and on cells dropped for missing samples
  GridBox region{};       ///< nodes; at least two an axis
  bool mirrored = false;  ///< the geometry mirrors: order triangles so that the mapped mesh looks outwards
  std::int64_t max_triangles = 500'000'000;
  int threads = 1;
};

/// Surface of the body { p in domain : range.low <= f(p) <= range.high }, as one welded mesh: M0.
///
/// volume   missing samples are NaN; the domain is every cell of the region without a missing corner.
/// returns  vertices on the 1/64 lattice, grouped by brick in Morton order; triangles look outwards. With cap the
///          mesh is closed and manifold by index; without it, manifold with boundary. Empty when nothing is in range.
///          The same bytes for any number of threads.
/// errors   invalid_argument: low > high, NaN, or a region that is not in the volume.  malformed_input: damaged brick.
///          limit_exceeded: more than max_triangles.  cancelled.
/// cost     O(active cells); bricks outside the range are not touched. Peak memory: result twice + one brick a thread.
/// source   Chernyaev 1995 for the cases; Tavares et al., section 2(d), for g; docs/architecture.md for the cap.
Result<IndexedMesh> extract_body(const BrickedVolume& volume, IsoRange range, const ExtractOptions& options,
                                 Progress& progress);

}  // namespace geosis
