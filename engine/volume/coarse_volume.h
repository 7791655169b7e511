#pragma once

#include <memory>

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/volume/bricks.h"
#include "engine/volume/grid.h"

namespace geosis {

/// Some nodes of a region, at equal distances, as a volume of its own: its node (a, b, c) is the region's first plus
/// (a, b, c) steps, its value untouched.
struct CoarseVolume {
  GridIndex first, step;
  std::unique_ptr<BrickedVolume> samples;  ///< in a temporary file
};

/// step     at least 1 on each axis; an axis keeps two nodes at least, so a larger one is cut.
/// errors   malformed_input: a damaged brick.  no_space, unavailable: of the temporary file.  cancelled.
/// cost     reads the traces that it keeps, whole.
Result<CoarseVolume> thin_out(const BrickedVolume& samples, const GridBox& region, GridIndex step, int threads,
                              Progress& progress);

}  // namespace geosis
