#include "engine/analysis/surface_distance.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <vector>

#include "engine/base/parallel.h"

namespace geosis {
namespace {

/// Points that one task handles. Fixed, so that sums do not depend on the number of threads.
constexpr std::size_t kChunk = 256;

struct OneSided {
  double mean = 0, max = 0;
};

struct Partial {
  double sum = 0, max = 0;
};

/// Neighbouring points have neighbouring nearest triangles: each search starts from the answer of the last.
Partial measure_chunk(const SurfaceSamples& samples, std::size_t first, std::size_t last, const TriangleGrid& grid) {
  Partial partial;
  NearestTriangle nearest;
  for (std::size_t s = first; s < last; ++s) {
    nearest = grid.find_nearest(samples.points[s], nearest.triangle);
    const double distance = std::sqrt(nearest.squared_distance);
    partial.max = std::max(partial.max, distance);
    if (s >= samples.vertices) partial.sum += distance;
  }
  return partial;
}

Error cancelled() {
  return {ErrorCode::cancelled, "measuring a distance was cancelled"};
}

Result<OneSided> measure_one_side(const SurfaceSamples& from, const TriangleGrid& to, int threads,
                                  const Progress& progress) {
  if (!to.is_built()) return cancelled();
  const std::size_t count = from.points.size();
  std::vector<Partial> partials((count + kChunk - 1) / kChunk);
  std::atomic<bool> is_cancelled = false;
  parallel_for(partials.size(), threads, [&](std::size_t chunk) {
    if (is_cancelled || progress.cancelled()) {
      is_cancelled = true;
      return;
    }
    partials[chunk] = measure_chunk(from, chunk * kChunk, std::min(count, (chunk + 1) * kChunk), to);
  });
  if (is_cancelled) return cancelled();
  Partial total;
  for (const Partial& partial : partials) {
    total.sum += partial.sum;
    total.max = std::max(total.max, partial.max);
  }
  return OneSided{total.sum / static_cast<double>(count - from.vertices), total.max};
}

}  // namespace

ReferenceSurface::ReferenceSurface(const IndexedMesh& mesh, const DistanceOptions& options, const Progress& progress)
    : options_(options),
      samples_(sample_surface(mesh, static_cast<std::size_t>(options.samples), progress)),
      grid_(mesh, progress) {}

Result<SurfaceDistance> ReferenceSurface::measure(const IndexedMesh& other, const Progress& progress) const {
  if (other.triangles.empty()) return SurfaceDistance{};
  if (!samples_) return samples_.error();
  const auto others = sample_surface(other, static_cast<std::size_t>(options_.samples), progress);
  if (!others) return others.error();
  const auto away = measure_one_side(*samples_, TriangleGrid(other, progress), options_.threads, progress);
  if (!away) return away.error();
  const auto back = measure_one_side(*others, grid_, options_.threads, progress);
  if (!back) return back.error();
  return SurfaceDistance{.mean_voxels = (away->mean + back->mean) / 2,
                         .max_voxels = std::max(away->max, back->max),
                         .samples = static_cast<std::int64_t>(samples_->points.size() + others->points.size())};
}

SurfaceDistance measure_distance(const IndexedMesh& a, const IndexedMesh& b, const DistanceOptions& options) {
  if (a.triangles.empty()) return {};
  return *ReferenceSurface(a, options).measure(b);
}

}  // namespace geosis
