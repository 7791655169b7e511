#include "engine/pipeline/stages.h"

#include <utility>

#include "engine/isosurface/select_bodies.h"
#include "engine/missing/fill.h"

namespace geosis {

Result<StageSamples> fill_stage(const ReconstructInput& input, const ReconstructOptions& options, Progress& progress) {
  if (options.fill.method == FillMethod::none || !has_missing(input.samples)) {
    return StageSamples{&input.samples, nullptr, nullptr};
  }
  if (input.filled != nullptr) return StageSamples{input.filled, input.filled, nullptr};
  auto made = fill_missing(input.samples, options.fill, std::nullopt, options.threads, progress);
  if (!made) return std::move(made).error();
  StageSamples stage{made->get(), made->get(), nullptr};
  stage.made = *std::move(made);
  return stage;
}

Result<LabelledSurface> extract_stage(const BrickedVolume& samples, const ReconstructOptions& options,
                                      const ExtractStage& stage, Progress& progress) {
  ExtractOptions extract;
  extract.mode = options.mode;
  extract.cap = options.cap;
  extract.region = options.region.value_or(whole(samples.shape()));
  extract.mirrored = stage.mirrored;
  extract.threads = options.threads;
  if (!stage.bodies && !stage.amplitudes && options.bodies.keeps_all()) {
    auto mesh = extract_body(samples, options.range, extract, progress);
    if (!mesh) return std::move(mesh).error();
    LabelledSurface surface;
    surface.mesh = *std::move(mesh);
    return surface;
  }
  const LabelOptions labels{.amplitudes = stage.amplitudes, .seeds = options.bodies.seeds};
  auto surface = extract_labelled_body(samples, options.range, extract, labels, progress);
  if (surface) select_bodies(*surface, options.bodies.filter());
  return surface;
}

}  // namespace geosis
