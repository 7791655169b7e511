#include "engine/pipeline/describe_bodies.h"

#include <utility>

#include "engine/missing/reliability_at.h"
#include "engine/pipeline/grid_stage.h"
#include "engine/pipeline/output_space.h"
#include "engine/pipeline/stages.h"

namespace geosis {
namespace {

/// Reliabilities of M0's vertices; none where every sample was measured.
///
/// rectified   set when M0 is on the rectified grid.
Result<std::vector<std::uint8_t>> reliabilities(const StageSamples& samples, const IndexedMesh& m0,
                                                const LayerMap* rectified, int threads, const Progress& progress) {
  if (samples.filled == nullptr) return std::vector<std::uint8_t>();
  if (rectified != nullptr) {
    return reliability_at(*samples.filled, to_samples(*rectified, m0.positions, threads), threads, progress);
  }
  return reliability_at(*samples.filled, m0.positions, threads, progress);
}

}  // namespace

Result<std::vector<DescribedBody>> describe_bodies(const ReconstructInput& input, const ReconstructOptions& options,
                                                   Progress& progress) {
  const auto space = output_space(input.geometry, options);
  if (!space) return space.error();
  auto grid = grid_stage(input, options, progress);
  if (!grid) return std::move(grid).error();
  const std::optional<LayerMap> layers = layer_map(*grid, input.samples.shape(), options);
  const auto samples = fill_stage(input, options, progress);
  if (!samples) return samples.error();
  const ExtractStage stage{
      .bodies = true, .amplitudes = true, .mirrored = space->mirrored(), .layers = layers ? &*layers : nullptr};
  const auto stage_surface = extract_stage(*samples->samples, options, stage, progress);
  if (!stage_surface) return stage_surface.error();
  const LabelledSurface* const m0 = &stage_surface->surface;
  const auto reliability =
      reliabilities(*samples, m0->mesh, layers && options.index_space ? &*layers : nullptr, options.threads, progress);
  if (!reliability) return reliability.error();
  if (progress.cancelled()) return Error{ErrorCode::cancelled, "describing the bodies was cancelled"};
  auto reports = report_bodies(m0->mesh, m0->body, m0->samples.size(), *space, *reliability);
  if (!reports) return std::move(reports).error();
  std::vector<DescribedBody> bodies;
  bodies.reserve(reports->size());
  for (std::size_t b = 0; b < reports->size(); ++b) bodies.push_back({(*reports)[b], m0->samples[b]});
  return bodies;
}

}  // namespace geosis
