#include "engine/pipeline/describe_bodies.h"

#include <utility>

#include "engine/missing/reliability_at.h"
#include "engine/pipeline/output_space.h"
#include "engine/pipeline/stages.h"

namespace geosis {
namespace {

/// Reliabilities of M0's vertices; none where every sample was measured.
Result<std::vector<std::uint8_t>> reliabilities(const StageSamples& samples, const IndexedMesh& m0, int threads,
                                                const Progress& progress) {
  if (samples.filled == nullptr) return std::vector<std::uint8_t>();
  return reliability_at(*samples.filled, m0.positions, threads, progress);
}

}  // namespace

Result<std::vector<DescribedBody>> describe_bodies(const ReconstructInput& input, const ReconstructOptions& options,
                                                   Progress& progress) {
  const auto space = output_space(input.geometry, options);
  if (!space) return space.error();
  const auto samples = fill_stage(input, options, progress);
  if (!samples) return samples.error();
  const ExtractStage stage{.bodies = true, .amplitudes = true, .mirrored = space->mirrored()};
  const auto m0 = extract_stage(*samples->samples, options, stage, progress);
  if (!m0) return m0.error();
  const auto reliability = reliabilities(*samples, m0->mesh, options.threads, progress);
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
