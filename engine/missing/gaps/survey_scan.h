#pragma once

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/base/vec3.h"
#include "engine/missing/brick_views.h"
#include "engine/missing/gaps/bit_lines.h"
#include "engine/volume/bricks.h"

namespace geosis {

/// What filling has to know of the whole survey.
struct SurveyScan {
  BrickViews views;
  BitLines valid;      ///< one line a trace, i * crosslines + j
  Vec3d step_lengths;  ///< see step_lengths()
};

/// Reads the volume once (twice if an axis has no neighbouring valid samples).
///
/// errors   malformed_input: a damaged brick.  cancelled.
Result<SurveyScan> scan_survey(const BrickedVolume& volume, int threads, Progress& progress);

}  // namespace geosis
