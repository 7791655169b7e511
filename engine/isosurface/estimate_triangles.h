#pragma once

#include "engine/isosurface/extract.h"
#include "engine/volume/bricks.h"

namespace geosis {

/// About how many triangles extract_body would make, from the index of block ranges alone: no sample is read.
///
/// A sheet {f = v} that passes a block of 16 cells an axis makes the more triangles the nearer v lies to the middle of
/// the block's values, and the more of the block's neighbours it passes as well: a speck is not a sheet. The factor was
/// measured (docs/estimates.md); on surveys and scans the estimate is within a factor of 2, on white noise, which an
/// index cannot tell from it, up to 10 too low.
///
/// options  max_triangles does not matter. A range or region that extract_body refuses gives 0.
/// cost     O(blocks of the bricks in the range); no memory.
double estimate_triangles(const BrickedVolume& volume, IsoRange range, const ExtractOptions& options);

}  // namespace geosis
