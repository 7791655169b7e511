#pragma once

#include <memory>

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/isosurface/labelled_surface.h"
#include "engine/pipeline/reconstruct.h"

namespace geosis {

/// The samples that a reconstruction works on.
struct StageSamples {
  const BrickedVolume* samples = nullptr;  ///< filled, when the options ask for it and something is missing
  const FilledVolume* filled = nullptr;    ///< the same, or null when nothing was filled
  std::unique_ptr<FilledVolume> made;      ///< keeps a fill that nobody had before
};

/// First stage: missing samples filled as the options say, by the input's own fill where it has one.
Result<StageSamples> fill_stage(const ReconstructInput& input, const ReconstructOptions& options, Progress& progress);

/// What the surface is needed with, besides what the options' filter of bodies needs.
struct ExtractStage {
  bool bodies = false;      ///< labels
  bool amplitudes = false;  ///< labels, and the samples of each body
  bool mirrored = false;    ///< the requested space mirrors
};

/// Second stage: M0, with the bodies kept that the options ask for. Without need of labels the surface has none.
Result<LabelledSurface> extract_stage(const BrickedVolume& samples, const ReconstructOptions& options,
                                      const ExtractStage& stage, Progress& progress);

}  // namespace geosis
