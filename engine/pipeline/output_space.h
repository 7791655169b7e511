#pragma once

#include "engine/base/result.h"
#include "engine/pipeline/reconstruct.h"
#include "engine/volume/geometry.h"

namespace geosis {

/// What the vertical axis is multiplied by on the way to world space.
double vertical_scale_of(const ReconstructOptions& options);

/// The space that a result is in: the world that the volume's geometry maps to, with depth in place of two-way time
/// where the options have a velocity (depth = time / 2 * velocity; times in ms, positive down), or index space.
///
/// errors   unsupported: world space of a geometry that is not affine.
Result<AffineGeometry> output_space(const GridGeometry& geometry, const ReconstructOptions& options);

}  // namespace geosis
