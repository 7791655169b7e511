#pragma once

#include <memory>
#include <optional>

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/isosurface/labelled_surface.h"
#include "engine/pipeline/reconstruct.h"
#include "engine/structure/layer_map.h"
#include "engine/structure/rectified_volume.h"

namespace geosis {

/// The samples that a reconstruction works on.
struct StageSamples {
  const BrickedVolume* samples = nullptr;  ///< filled, when the options ask for it and something is missing
  const FilledVolume* filled = nullptr;    ///< the same, or null when nothing was filled
  std::unique_ptr<FilledVolume> made;      ///< keeps a fill that nobody had before
};

/// Second stage: missing samples filled as the options say, by the input's own fill where it has one.
Result<StageSamples> fill_stage(const ReconstructInput& input, const ReconstructOptions& options, Progress& progress);

/// The surface that the options ask for, of samples of this shape.
ExtractOptions extract_options(const ReconstructOptions& options, GridShape shape);

/// What the surface is needed with, besides what the options' filter of bodies needs.
struct ExtractStage {
  bool bodies = false;               ///< labels
  bool amplitudes = false;           ///< labels, and the samples of each body
  bool mirrored = false;             ///< the requested space mirrors
  bool is_bent = false;              ///< bend_surface follows, which chooses the largest bodies
  const LayerMap* layers = nullptr;  ///< of the structural grid, cut to the region; null = the axis grid
};

/// M0, and what of the structural grid later stages need.
struct StageSurface {
  LabelledSurface surface;
  RectifiedVolume rectified;              ///< without samples on the axis grid
  std::optional<EmptyReason> empty = {};  ///< set when the surface has no triangles
};

/// Third stage: M0, with the bodies kept that the options ask for. Without need of labels the surface has none.
Result<StageSurface> extract_stage(const BrickedVolume& samples, const ReconstructOptions& options,
                                   const ExtractStage& stage, Progress& progress);

}  // namespace geosis
