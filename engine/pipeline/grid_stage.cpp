#include "engine/pipeline/grid_stage.h"

#include <algorithm>
#include <utility>

#include "engine/missing/fill.h"

namespace geosis {
namespace {

constexpr double kWorthwhileShare = 0.125;  // of the dominant period: about half a peak's width

/// The measured samples with gaps filled linearly, or none when there are no gaps.
Result<std::unique_ptr<FilledVolume>> fill_for_dips(const BrickedVolume& measured, int threads, Progress& progress) {
  if (!has_missing(measured)) return std::unique_ptr<FilledVolume>();
  return fill_missing(measured, {.method = FillMethod::linear}, std::nullopt, threads, progress);
}

DipSamples dip_samples(const BrickedVolume& measured, const FilledVolume* filled) {
  if (filled == nullptr) return {measured, nullptr};
  return {*filled, &measured};
}

}  // namespace

Result<StructuralGrid> lay_structural_grid(const BrickedVolume& measured, int threads, Progress& progress) {
  auto filled = fill_for_dips(measured, threads, progress);
  if (!filled) return std::move(filled).error();
  return build_structural_grid(dip_samples(measured, filled->get()), {.threads = threads}, progress);
}

Result<DipReport> report_dips(const BrickedVolume& measured, int threads, Progress& progress) {
  auto filled = fill_for_dips(measured, threads, progress);
  if (!filled) return std::move(filled).error();
  auto dips = measure_dips(dip_samples(measured, filled->get()), threads, progress);
  if (!dips) return std::move(dips).error();
  return dips->report;
}

bool prefers_structure(const DipReport& dips) {
  return std::max(dips.dips[0].p95, dips.dips[1].p95) > kWorthwhileShare * dips.period;
}

Result<StageGrid> grid_stage(const ReconstructInput& input, const ReconstructOptions& options, Progress& progress) {
  StageGrid stage;
  if (options.grid == GridChoice::given) return stage;
  stage.report.emplace();
  if (options.grid == GridChoice::curvilinear) {
    if (input.nodes != nullptr) stage.report->nodes = input.nodes->report();
    return stage;
  }
  if (options.grid == GridChoice::automatic) {
    auto dips = input.dips != nullptr   ? Result<DipReport>(*input.dips)
                : input.grid != nullptr ? Result<DipReport>(input.grid->report.dips)
                                        : report_dips(input.samples, options.threads, progress);
    if (!dips) return std::move(dips).error();
    stage.report->dips = *dips;
    if (!prefers_structure(*dips)) return stage;
  }
  if (input.grid == nullptr) {
    auto made = lay_structural_grid(input.samples, options.threads, progress);
    if (!made) return std::move(made).error();
    stage.made = std::make_unique<const StructuralGrid>(*std::move(made));
  }
  stage.structural = input.grid != nullptr ? input.grid : stage.made.get();
  stage.report->dips = stage.structural->report.dips;
  stage.report->structure = stage.structural->report;
  stage.report->layers = stage.structural->paths.layers();
  return stage;
}

std::optional<LayerMap> layer_map(const StageGrid& grid, GridShape shape, const ReconstructOptions& options) {
  if (grid.structural == nullptr) return std::nullopt;
  return LayerMap(grid.structural->paths, options.region.value_or(whole(shape)));
}

}  // namespace geosis
