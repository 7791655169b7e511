#include "server/app/extractions/compute.h"

#include <atomic>
#include <chrono>
#include <optional>
#include <string>

#include "server/documents/empty_reason.h"
#include "server/documents/manifest.h"

namespace geosis::server {
namespace {

ManifestUrls service_urls() {
  const auto level_path = [](std::size_t level) { return "lods/" + std::to_string(level); };
  return {.level = [=](std::size_t level, std::size_t) { return std::optional(level_path(level) + ".drc"); },
          .part = [=](std::size_t level, std::size_t part,
                      std::size_t) { return level_path(level) + "/parts/" + std::to_string(part) + ".drc"; },
          .bodies = "bodies"};
}

/// Passes reports on, and stops the work when a part could not be kept.
class StoppableProgress final : public Progress {
 public:
  explicit StoppableProgress(Progress& outer) : outer_(outer) {}
  void report(const char* stage, double fraction) override { outer_.report(stage, fraction); }
  bool cancelled() const override { return stopped_ || outer_.cancelled(); }
  void stop() { stopped_ = true; }

 private:
  Progress& outer_;
  std::atomic<bool> stopped_{false};
};

Result<void> write_parts(const ReconstructedLevel& level, std::size_t number, const PartWriter& write_part) {
  for (std::size_t p = 0; p < level.encoded.parts.size(); ++p) {
    auto written = write_part(static_cast<int>(number), static_cast<int>(p), level.encoded.parts[p].bytes);
    if (!written) return written;
  }
  return {};
}

}  // namespace

ReconstructInput reconstruct_input(const ExtractionInput& input, const ReconstructOptions& options) {
  return {.samples = input.samples,
          .geometry = input.volume.geometry,
          .has_lengths = has_lengths(input.volume, options),
          .filled = input.filled,
          .grid = input.grid,
          .dips = input.dips,
          .attribute_volume = input.attribute_volume,
          .nodes = input.nodes};
}

Result<ComputedExtraction> compute_extraction(Extraction& extraction, const ExtractionInput& input,
                                              const ReconstructOptions& options, const ReconstructFunction& reconstruct,
                                              const PartWriter& write_part, Progress& progress,
                                              ExtractionTimings& timings) {
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  const auto seconds = [&] { return std::chrono::duration<double>(Clock::now() - start).count(); };
  const ManifestUrls urls = service_urls();
  StoppableProgress stoppable(progress);
  std::optional<Error> failed;
  const LevelSink show_level = [&](std::size_t number, const ReconstructedLevel& level) {
    if (failed) return;
    if (auto written = write_parts(level, number, write_part); !written) {
      failed = written.error();
      stoppable.stop();
      return;
    }
    if (timings.first_level == 0) timings.first_level = timings.load + timings.grid + timings.fill + seconds();
    extraction.add_level(early_level_document(level, number, input.volume, options, urls));
  };

  StageTimings stages;
  const auto result = reconstruct(reconstruct_input(input, options), options, stoppable, &stages, show_level);
  if (failed) return *std::move(failed);
  if (!result) return result.error();
  timings.total = timings.load + timings.grid + timings.fill + seconds();
  timings.grid += stages.grid;
  timings.fill += stages.fill;
  timings.extract = stages.extract;
  timings.simplify = stages.simplify;
  timings.encode = stages.encode;
  timings.certify = stages.certify;
  return ComputedExtraction{manifest_document(input.volume, options, *result, urls),
                            empty_reason_document(result->empty)};
}

}  // namespace geosis::server
