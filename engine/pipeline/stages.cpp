#include "engine/pipeline/stages.h"

#include <algorithm>
#include <utility>

#include "engine/isosurface/brick_sweep.h"
#include "engine/isosurface/renumber_bodies.h"
#include "engine/isosurface/select_bodies.h"
#include "engine/mesh/empty_edges.h"
#include "engine/missing/fill.h"

namespace geosis {
namespace {

Result<LabelledSurface> extract_unlabelled(const BrickedVolume& samples, IsoRange range, const ExtractOptions& options,
                                           Progress& progress) {
  auto mesh = extract_body(samples, range, options, progress);
  if (!mesh) return std::move(mesh).error();
  LabelledSurface surface;
  surface.mesh = *std::move(mesh);
  return surface;
}

/// The seed's first node on the rectified grid; one that is nowhere for a seed outside the region.
GridIndex rectified_seed(const LayerMap& layers, GridIndex first, GridIndex seed) {
  for (int axis = 0; axis < 3; ++axis) {
    if (seed[axis] < layers.region().first[axis] || seed[axis] > layers.region().last[axis]) return {-1, -1, -1};
  }
  const std::int32_t layer = std::max(layers.paths().layer_of(seed.i, seed.j, seed.k), first.k);
  return {seed.i - first.i, seed.j - first.j, layer - first.k};
}

/// Labels on a rectified grid, whose node (0, 0, 0) is `first`: every sample counts once.
void follow_layers(const LayerMap& layers, GridIndex first, LabelOptions& labels) {
  for (GridIndex& seed : labels.seeds) seed = rectified_seed(layers, first, seed);
  labels.counted = [&layers, first](std::int32_t i, std::int32_t j, std::int32_t k, int count) {
    return first_passes(layers, first.i + i, first.j + j, first.k + k, count, first.k);
  };
}

/// From the rectified grid's own numbering to the volume's: to the samples' places, or in index space to the whole
/// grid's layers.
Result<void> leave_layers(const LayerMap& layers, GridIndex first, const ReconstructOptions& options, bool mirrored,
                          const Progress& progress, LabelledSurface& surface) {
  const Vec3f shift = {static_cast<float>(first.i), static_cast<float>(first.j), static_cast<float>(first.k)};
  for (Vec3f& p : surface.mesh.positions) p = p + shift;
  if (options.index_space || surface.mesh.triangles.empty()) return {};
  surface.mesh.positions = to_samples(layers, surface.mesh.positions, options.threads);
  const auto index = collapse_empty_edges(surface.mesh, progress);
  if (!index) return index.error();
  for (std::size_t v = 0; v < surface.body.size(); ++v) {
    if ((*index)[v] >= 0) surface.body[static_cast<std::size_t>((*index)[v])] = surface.body[v];
  }
  if (!surface.body.empty()) surface.body.resize(surface.mesh.positions.size());
  renumber_bodies(surface, options.cap, mirrored);
  return {};
}

bool has_surface(const LabelledSurface& surface) {
  return !surface.mesh.triangles.empty();
}

/// Why no body passes the filter.
EmptyReason refused_by(const BodyFilter& filter, const std::vector<std::optional<std::uint32_t>>& seed_body) {
  const bool has_seeded = std::any_of(seed_body.begin(), seed_body.end(), [](auto body) { return body.has_value(); });
  return filter.seeded && !has_seeded ? EmptyReason::no_seeded_body : EmptyReason::too_small;
}

/// Keeps the bodies that pass; says why when nothing is left to show.
std::optional<EmptyReason> keep_bodies(LabelledSurface& surface, const BodyFilter& filter) {
  const EmptyReason refusal = refused_by(filter, surface.seed_body);
  select_bodies(surface, filter);
  if (has_surface(surface)) return std::nullopt;
  return surface.samples.empty() ? refusal : EmptyReason::no_surface;
}

}  // namespace

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

ExtractOptions extract_options(const ReconstructOptions& options, GridShape shape) {
  ExtractOptions extract;
  extract.mode = options.mode;
  extract.cap = options.cap;
  extract.region = options.region.value_or(whole(shape));
  extract.threads = options.threads;
  return extract;
}

Result<StageSurface> extract_stage(const BrickedVolume& samples, const ReconstructOptions& options,
                                   const ExtractStage& stage, Progress& progress) {
  ExtractOptions extract = extract_options(options, samples.shape());
  extract.mirrored = stage.mirrored;
  LabelOptions labels{.amplitudes = stage.amplitudes, .seeds = options.bodies.seeds};
  const bool is_labelled = stage.bodies || stage.amplitudes || !options.bodies.keeps_all();
  StageSurface result;
  const BrickedVolume* field = &samples;
  if (stage.layers != nullptr) {
    if (auto fits = check_request(samples.shape(), options.range, extract); !fits) return std::move(fits).error();
    auto rectified = rectify(samples, *stage.layers, options.threads, progress);
    if (!rectified) return std::move(rectified).error();
    result.rectified = *std::move(rectified);
    field = result.rectified.samples.get();
    extract.region = whole(field->shape());
    follow_layers(*stage.layers, result.rectified.first, labels);
  }
  auto surface = is_labelled ? extract_labelled_body(*field, options.range, extract, labels, progress)
                             : extract_unlabelled(*field, options.range, extract, progress);
  if (!surface) return std::move(surface).error();
  result.surface = *std::move(surface);
  if (!has_surface(result.surface))
    result.empty = options.cap ? EmptyReason::nothing_in_range : EmptyReason::no_surface;
  if (stage.layers != nullptr) {
    auto left = leave_layers(*stage.layers, result.rectified.first, options, stage.mirrored, progress, result.surface);
    if (!left) return std::move(left).error();
    if (!result.empty && !has_surface(result.surface)) result.empty = EmptyReason::no_surface;
  }
  BodyFilter filter = options.bodies.filter();
  if (stage.is_bent) filter.largest.reset();
  if (is_labelled) {
    const auto refused = keep_bodies(result.surface, filter);
    if (!result.empty) result.empty = refused;
  }
  return result;
}

}  // namespace geosis
