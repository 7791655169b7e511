#pragma once

#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "engine/base/progress.h"
#include "engine/isosurface/labelled_surface.h"
#include "engine/volume/brick_file.h"

/// Small volumes from formulas, and their labelled surfaces.
namespace geosis {

inline std::unique_ptr<BrickedVolume> sample_field(GridShape shape, const std::function<double(int, int, int)>& f) {
  std::vector<float> samples;
  samples.reserve(static_cast<std::size_t>(shape.count()));
  for (int i = 0; i < shape.inlines; ++i) {
    for (int j = 0; j < shape.crosslines; ++j) {
      for (int k = 0; k < shape.samples; ++k) samples.push_back(static_cast<float>(f(i, j, k)));
    }
  }
  return make_bricked_volume(shape, samples);
}

/// Of the whole volume unless the options say otherwise; a failure of the running test, and nothing, when it fails.
inline LabelledSurface label(const BrickedVolume& volume, IsoRange range, ExtractOptions options = {},
                             const LabelOptions& labels = {}) {
  if (options.region == GridBox{}) options.region = whole(volume.shape());
  NoProgress progress;
  auto surface = extract_labelled_body(volume, range, options, labels, progress);
  if (surface) return std::move(surface).value();
  ADD_FAILURE() << surface.error().message;
  return {};
}

}  // namespace geosis
