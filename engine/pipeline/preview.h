#pragma once

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/pipeline/reconstruct.h"
#include "engine/volume/grid.h"

namespace geosis {

/// How far apart the nodes are that a preview of a region reads: traces four times as far as samples, as reflectors
/// change faster downwards, and so far that there are at most 1.5 million nodes and about 150,000 triangles.
///
/// triangles   of the whole surface, about.
GridIndex preview_step(const GridBox& region, double triangles);

/// How many times fewer triangles a surface has at such a step: it crosses cells of two axes.
double thinning(GridIndex step);

/// The options of the preview of what these ask for: one level of the given grid, nothing filled, no values of other
/// volumes. Equal previews have equal options.
ReconstructOptions preview_options(ReconstructOptions options);

/// A coarse look at a body, for whoever still chooses its range: the exact surface of every few samples. It may have
/// lost what is thin and joined what is apart.
///
/// options   those of preview_options.
/// errors    as reconstruct.
/// cost      of 512 x 512 x 512 samples at most a 64th is read and a million extracted.
Result<Reconstruction> reconstruct_preview(const ReconstructInput& input, const ReconstructOptions& options,
                                           Progress& progress, StageTimings* timings, const LevelSink& on_level);

}  // namespace geosis
