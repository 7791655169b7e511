#include "engine/pipeline/estimate.h"

#include <algorithm>
#include <cmath>

#include "engine/isosurface/estimate_triangles.h"
#include "engine/pipeline/preview.h"
#include "engine/pipeline/stages.h"

namespace geosis {
namespace {

// Measured, docs/estimates.md.
constexpr double kFixedBytes = 4096;            // of a result, however small
constexpr double kBytesPerTriangle = 1.6;       // encoded, of any level
constexpr double kMoreBytesPerAttribute = 0.3;  // each: normals, bodies, reliability, value
constexpr double kFixedMemory = 1 << 20;
constexpr double kMemoryPerThread = 1 << 19;
constexpr double kMemoryPerTriangle = 125;  // of M0
constexpr double kMemoryPerPlacedTriangle =
    24;  // positions in the world, places among samples; nodes are a mapped file
constexpr double kSecondsPerPlacedTriangle = 0.7e-6;
constexpr double kFixedSeconds = 0.15;  // of one core
constexpr double kSecondsPerTriangle = 2.2e-6;
constexpr double kParallelShare = 0.85;
constexpr double kGridMemoryPerSample = 8;  // of laying a structural grid, which is over before there are triangles
constexpr double kGridSecondsPerSample = 0.25e-6;

/// Triangles of all levels together, for each of M0.
double levels_per_triangle(const ReconstructOptions& options) {
  double sum = 0;
  for (const LevelTarget& level : options.levels) sum += level.ratio.value_or(1);
  return sum;
}

bool may_be_structural(const ReconstructOptions& options) {
  return options.grid == GridChoice::structural || options.grid == GridChoice::automatic;
}

double attributes(const ReconstructOptions& options, bool is_filled) {
  return (options.normals ? 1 : 0) + (options.attributes.body ? 1 : 0) + (options.attributes.value ? 1 : 0) +
         (options.attributes.agreement && may_be_structural(options) ? 1 : 0) +
         (options.attributes.reliability && is_filled ? 1 : 0);
}

}  // namespace

ReconstructEstimate estimate_reconstruction(const BrickedVolume& samples, const ReconstructOptions& options) {
  const ExtractOptions extract = extract_options(options, samples.shape());
  double triangles = estimate_triangles(samples, options.range, extract);
  if (options.preview) triangles /= thinning(preview_step(extract.region, triangles));
  const bool is_filled = options.fill.method != FillMethod::none && has_missing(samples);
  const double threads = std::max(options.threads, 1);
  const double bytes_per_triangle = kBytesPerTriangle + kMoreBytesPerAttribute * attributes(options, is_filled);
  const double laid = may_be_structural(options) ? static_cast<double>(samples.shape().count()) : 0;
  const bool is_placed = options.grid == GridChoice::curvilinear && !options.index_space;
  const double per_triangle = kMemoryPerTriangle + (is_placed ? kMemoryPerPlacedTriangle : 0);
  const double seconds_per_triangle = kSecondsPerTriangle + (is_placed ? kSecondsPerPlacedTriangle : 0);
  const double one_core = kFixedSeconds + seconds_per_triangle * triangles + kGridSecondsPerSample * laid;
  const double memory = std::max(per_triangle * triangles, kGridMemoryPerSample * laid);
  return {
      .triangles = static_cast<std::uint64_t>(triangles),
      .bytes = static_cast<std::uint64_t>(kFixedBytes + bytes_per_triangle * levels_per_triangle(options) * triangles),
      .memory_bytes = static_cast<std::uint64_t>(kFixedMemory + kMemoryPerThread * threads + memory),
      .processor_seconds = one_core,
      .seconds = one_core * (1 - kParallelShare + kParallelShare / threads)};
}

}  // namespace geosis
