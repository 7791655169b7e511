#pragma once

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/missing/axis_barycentre.h"
#include "engine/missing/file/fill_writer.h"
#include "engine/missing/fill_share.h"
#include "engine/missing/gaps/bit_lines.h"
#include "engine/missing/gaps/gap_jobs.h"
#include "engine/missing/solve_gap.h"
#include "engine/volume/bricks.h"

namespace geosis {

/// What the solvers of gaps need besides each other.
struct GapSurvey {
  const BrickedVolume& volume;
  const AxisBarycentre& barycentre;  ///< where they start from
  const BitLines& nodes;             ///< missing inside the outline, one line a trace
  GridShape shape() const { return volume.shape(); }
};

/// Replaces the values of the writer's records by those that the solver gives, clamped to the range of the volume's
/// valid samples. A node that the solver leaves without a finite value keeps the one that it has.
///
/// Gaps are solved whole, or in tiles that overlap, later ones with the values of earlier ones around them. What is cut
/// where depends on the data alone, so the values are the same for any number of threads.
/// writer   has records with places and values; nodes without a record are solved for and dropped.
/// errors   malformed_input: a damaged brick; the solver's; cancelled.
/// cost     memory: 12 bytes a run of nodes, 32 a gap, and one box a thread: up to 1 million nodes for six threads at
///          once, up to 4 million for two.
Result<void> fill_gaps(const GapSurvey& survey, const GapSolver& solver, const GapLimits& limits, FillWriter& writer,
                       int threads, Progress& progress, double from, double to);

}  // namespace geosis
