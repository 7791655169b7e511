#pragma once

#include <cstdint>

#include "engine/base/progress.h"
#include "engine/base/vec3.h"
#include "engine/missing/fill_options.h"
#include "engine/missing/gaps/gap_box.h"
#include "engine/missing/plate/thin_plate_options.h"

namespace geosis {

/// Surroundings that a gap's box needs on each side, where the volume has them: the dips are found from them.
inline constexpr std::int32_t kSteeringMarginTraces = 8;
inline constexpr std::int32_t kSteeringMarginSamples = 16;

/// Automatic steering takes gaps of at least so many traces in each lateral direction.
inline constexpr std::int32_t kLeastSteeredTraces = 4;

/// Whether the gap is to be filled along the dips. Automatic: when 4 x 4 neighbouring traces lack samples and the
/// samples around look like planes (mean planarity above one half).
///
/// cost     as find_dips_by_tensor, when it must look.
bool wants_steering(const GapBox& gap, FillSteering steering, const Progress& progress);

/// Fills the wanted nodes with the thin plate that takes its lateral neighbours along the reflectors: the least sum
/// over nodes of the squared second differences along the axes and twice the squared mixed ones, each weighted by the
/// inverse squares of the step lengths, where the neighbour of (i, j, k) on the next inline is (i + 1, j, k + dip).
/// Dips, and how much shorter lateral steps are along them, come from the box itself, and once more from the filled
/// one.
///
/// gap           on entry wanted nodes hold a first guess; it stands in for dips and values that nothing around tells.
///               Known nodes keep every bit. Traces of fewer than four samples tell no dips: they are filled as
///               fill_thin_plate does. A cancelled call leaves the gap as it was.
/// step_lengths  of the three axes on the level, above zero; only their ratios matter.
/// options       the solver stops at ten times the tolerance: further on the plate bends to errors of the dips.
/// result        finite, in [options.low, options.high]; the same on any machine.
/// cost          measured 6-15 us a wanted node on one core of a busy machine; 42 bytes a node of the box beside the
/// box. source        the thin plate of Briggs 1974 on a grid sheared along the dips.
void fill_steered_plate(GapBox& gap, const Vec3d& step_lengths, const ThinPlateOptions& options,
                        const Progress& progress);

}  // namespace geosis
