#include "engine/pipeline/describe_bodies.h"

#include <utility>

#include "engine/missing/reliability_at.h"
#include "engine/pipeline/curved_space.h"
#include "engine/pipeline/grid_stage.h"
#include "engine/pipeline/output_space.h"
#include "engine/pipeline/stages.h"

namespace geosis {
namespace {

/// Reliabilities at places among the samples; none where every sample was measured.
Result<std::vector<std::uint8_t>> reliabilities(const StageSamples& samples, const std::vector<Vec3f>& places,
                                                int threads, const Progress& progress) {
  if (samples.filled == nullptr) return std::vector<std::uint8_t>();
  return reliability_at(*samples.filled, places, threads, progress);
}

/// M0 in the coordinates that its levels would have.
struct PlacedSurface {
  LabelledSurface surface;
  AffineGeometry space;       ///< from them to the requested space
  std::vector<Vec3f> places;  ///< of its vertices among the samples
};

Result<PlacedSurface> place_surface(const ReconstructInput& input, const ReconstructOptions& options,
                                    const BrickedVolume& samples, const LayerMap* layers, Progress& progress) {
  const GridGeometry& geometry = input.grid_geometry();
  const bool is_curved = is_curved_space(geometry, options);
  PlacedSurface placed;
  if (!is_curved) {
    auto space = output_space(input.geometry, options);
    if (!space) return std::move(space).error();
    placed.space = *space;
  }
  const ExtractStage stage{.bodies = true,
                           .amplitudes = true,
                           .mirrored = is_curved ? geometry.mirrored() : placed.space.mirrored(),
                           .is_bent = is_curved,
                           .layers = layers};
  auto extracted = extract_stage(samples, options, stage, progress);
  if (!extracted) return std::move(extracted).error();
  placed.surface = std::move(extracted->surface);
  const std::vector<Vec3f>& positions = placed.surface.mesh.positions;
  placed.places =
      layers != nullptr && options.index_space ? to_samples(*layers, positions, options.threads) : positions;
  if (!is_curved || positions.empty()) return placed;
  auto curved = bend_surface(geometry, samples.shape(), options, progress, placed.surface);
  if (!curved) return std::move(curved).error();
  placed.space = curved->space;
  placed.places = std::move(curved->places);
  return placed;
}

}  // namespace

Result<std::vector<DescribedBody>> describe_bodies(const ReconstructInput& input, const ReconstructOptions& options,
                                                   Progress& progress) {
  if (options.preview) return std::vector<DescribedBody>();
  auto grid = grid_stage(input, options, progress);
  if (!grid) return std::move(grid).error();
  const std::optional<LayerMap> layers = layer_map(*grid, input.samples.shape(), options);
  const auto samples = fill_stage(input, options, progress);
  if (!samples) return samples.error();
  const auto m0 = place_surface(input, options, *samples->samples, layers ? &*layers : nullptr, progress);
  if (!m0) return m0.error();
  const auto reliability = reliabilities(*samples, m0->places, options.threads, progress);
  if (!reliability) return reliability.error();
  if (progress.cancelled()) return Error{ErrorCode::cancelled, "describing the bodies was cancelled"};
  const LabelledSurface& surface = m0->surface;
  auto reports = report_bodies(surface.mesh, surface.body, surface.samples.size(), m0->space, *reliability);
  if (!reports) return std::move(reports).error();
  std::vector<DescribedBody> bodies;
  bodies.reserve(reports->size());
  for (std::size_t b = 0; b < reports->size(); ++b) bodies.push_back({(*reports)[b], surface.samples[b]});
  return bodies;
}

}  // namespace geosis
