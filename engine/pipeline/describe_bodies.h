#pragma once

#include <vector>

#include "engine/analysis/body_report.h"
#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/isosurface/labelled_surface.h"
#include "engine/pipeline/reconstruct.h"

namespace geosis {

/// One body: what its surfaces tell, in the requested space, and what its samples do.
struct DescribedBody {
  BodyReport surface;
  BodySamples samples;
};

/// What each body of a reconstruction's M0 is: its measures in the requested space, its samples, its topology. A body's
/// place is its number, the one that the attribute `body` has; the largest comes first.
///
/// A function of its own: it reads all samples in the range, which the surface does not need.
///
/// returns  nothing for a preview, whose bodies are not those of the samples.
/// errors   those of reconstruct.
/// cost     extraction and half as much again, and one read of the bricks that hold samples in the range.
Result<std::vector<DescribedBody>> describe_bodies(const ReconstructInput& input, const ReconstructOptions& options,
                                                   Progress& progress);

}  // namespace geosis
