#include "engine/structure/rectified_volume.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "engine/base/parallel.h"
#include "engine/volume/brick_writer.h"
#include "engine/volume/sample_box.h"

namespace geosis {
namespace {

constexpr std::int32_t kPlanes = 8;  // read at a time

/// Layers between which any trace of the region goes on; at least two.
struct Layers {
  std::int32_t first, last;
};
Layers moving_layers(const LayerMap& map, int threads) {
  const GridBox& region = map.region();
  const auto planes = static_cast<std::size_t>(region.last.i - region.first.i + 1);
  std::vector<Layers> of_plane(planes, {map.paths().layers() - 2, 1});
  parallel_for(planes, threads, [&](std::size_t n) {
    const std::int32_t i = region.first.i + static_cast<std::int32_t>(n);
    for (std::int32_t j = region.first.j; j <= region.last.j; ++j) {
      of_plane[n].first = std::min(of_plane[n].first, map.paths().layer_of(i, j, region.first.k + 1) - 1);
      of_plane[n].last = std::max(of_plane[n].last, map.paths().layer_of(i, j, region.last.k));
    }
  });
  Layers all = of_plane.front();
  for (const Layers& plane : of_plane) all = {std::min(all.first, plane.first), std::max(all.last, plane.last)};
  return all;
}

}  // namespace

Result<RectifiedVolume> rectify(const BrickedVolume& samples, const LayerMap& map, int threads, Progress& progress) {
  const GridBox& region = map.region();
  const Layers layers = moving_layers(map, threads);
  const GridShape shape = {region.last.i - region.first.i + 1, region.last.j - region.first.j + 1,
                           layers.last - layers.first + 1};
  auto writer = BrickWriter::create(shape, std::nullopt);
  if (!writer) return std::move(writer).error();
  for (std::int32_t first = region.first.i; first <= region.last.i; first += kPlanes) {
    if (progress.cancelled()) return Error{ErrorCode::cancelled, "laying samples along the layers was cancelled"};
    const std::int32_t last = std::min(first + kPlanes - 1, region.last.i);
    const auto box = read_box(samples, {{first, region.first.j, region.first.k}, {last, region.last.j, region.last.k}});
    if (!box) return box.error();
    parallel_for(static_cast<std::size_t>(last - first + 1), threads, [&](std::size_t n) {
      const std::int32_t i = first + static_cast<std::int32_t>(n);
      std::vector<std::int32_t> path(static_cast<std::size_t>(map.paths().layers()));
      std::vector<float> trace(static_cast<std::size_t>(shape.samples));
      for (std::int32_t j = region.first.j; j <= region.last.j; ++j) {
        map.paths().get(i, j, path);
        const float* from = &box->value[box->at(i - first, j - region.first.j, 0)];
        for (std::size_t u = 0; u < trace.size(); ++u) {
          const std::int32_t k = path[static_cast<std::size_t>(layers.first) + u];
          trace[u] = from[std::clamp(k, region.first.k, region.last.k) - region.first.k];
        }
        writer->put(i - region.first.i, j - region.first.j, 0, trace);
      }
    });
  }
  auto rectified = std::move(*writer).finish(threads, progress);
  if (!rectified) return std::move(rectified).error();
  return RectifiedVolume{{region.first.i, region.first.j, layers.first}, *std::move(rectified)};
}

std::uint64_t first_passes(const LayerMap& map, std::int32_t i, std::int32_t j, std::int32_t layer, int count,
                           std::int32_t first_layer) {
  std::uint64_t bits = 0;
  std::int32_t before = layer > first_layer ? map.sample_at(i, j, layer - 1) : -1;
  for (int n = 0; n < count; ++n) {
    const std::int32_t here = map.sample_at(i, j, layer + n);
    if (here != before) bits |= std::uint64_t{1} << n;
    before = here;
  }
  return bits;
}

}  // namespace geosis
