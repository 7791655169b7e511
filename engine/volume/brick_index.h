#pragma once

#include <span>

#include "engine/volume/brick_format.h"
#include "engine/volume/bricks.h"
#include "engine/volume/grid.h"

namespace geosis {

/// Range, flags and checksum of one brick's samples (extent, sample fastest), and the ranges of its blocks: block
/// (a, b, c) covers the samples 16a .. 16a + 16 of each axis, as far as the brick goes.
///
/// cost  one read of the brick; vector code by the compiler, the same result on any processor.
StoredSummary index_brick(std::span<const float> samples, GridShape extent,
                          std::span<ValueRange, kBlocksPerBrick> blocks);

}  // namespace geosis
