#pragma once

#include <functional>

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/base/vec3.h"
#include "engine/missing/fill_options.h"
#include "engine/missing/gaps/gap_box.h"
#include "engine/missing/gaps/gap_jobs.h"
#include "engine/volume/bricks.h"

namespace geosis {

/// Fills the wanted nodes of one box; called from several threads at once. errors: as the method's, cancelled.
using GapSolver = std::function<Result<void>(GapBox& gap, Progress& progress)>;

/// A solver, and the gaps that it wants with more surroundings.
struct GapMethod {
  GapSolver solve;
  WideGaps wide;
};

/// The method for the gaps of a volume that the options ask for; method is rbf. This is the one place that knows the
/// methods behind rbf.
///
/// errors   unsupported: the kernel.  Whatever the method needs to prepare itself: malformed_input, cancelled.
Result<GapMethod> make_gap_method(const BrickedVolume& volume, const FillOptions& options, Vec3d step_lengths,
                                  int threads, Progress& progress);

}  // namespace geosis
