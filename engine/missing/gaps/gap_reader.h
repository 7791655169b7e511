#pragma once

#include <cstdint>
#include <vector>

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/missing/fill_gaps.h"
#include "engine/missing/gaps/gap_box.h"
#include "engine/missing/gaps/gap_jobs.h"
#include "engine/missing/gaps/gaps.h"

namespace geosis {

/// The box of a job, with `margin` layers around what it solves: its nodes wanted, from the axis barycentre; valid
/// samples known; nodes of the same gap known that an earlier wave has decided, or that lie beyond what the job solves
/// (by the axis barycentre); nodes of other gaps absent, as are those outside the outline.
///
/// errors   malformed_input: a damaged brick.  cancelled.
Result<GapBox> read_gap(const GapSurvey& survey, const Gaps& gaps, const GapPlan& plan, const GapJob& job,
                        GridShape margin, FillWriter& writer, const Progress& progress);

}  // namespace geosis
