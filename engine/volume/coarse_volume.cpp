#include "engine/volume/coarse_volume.h"

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

/// One plane of the coarse volume.
Result<void> keep_plane(const BrickedVolume& samples, const GridBox& region, GridIndex step, std::int32_t a,
                        BrickWriter& writer) {
  const GridShape shape = writer.layout().shape();
  const std::int32_t i = region.first.i + a * step.i;
  std::vector<float> kept(static_cast<std::size_t>(shape.samples));
  for (std::int32_t b = 0; b < shape.crosslines; ++b) {
    const std::int32_t j = region.first.j + b * step.j;
    const auto trace = read_box(samples, {{i, j, region.first.k}, {i, j, region.last.k}});
    if (!trace) return trace.error();
    for (std::size_t c = 0; c < kept.size(); ++c) kept[c] = trace->value[c * static_cast<std::size_t>(step.k)];
    writer.put(a, b, 0, kept);
  }
  return {};
}

}  // namespace

Result<CoarseVolume> thin_out(const BrickedVolume& samples, const GridBox& region, GridIndex step, int threads,
                              Progress& progress) {
  GridShape shape;
  const auto nodes_of = [&](int axis) {
    const std::int32_t cells = region.last[axis] - region.first[axis];
    step[axis] = std::min(step[axis], cells);
    return cells / step[axis] + 1;
  };
  shape = {nodes_of(0), nodes_of(1), nodes_of(2)};
  auto writer = BrickWriter::create(shape, std::nullopt);
  if (!writer) return std::move(writer).error();
  std::vector<Result<void>> outcomes(static_cast<std::size_t>(shape.inlines));
  parallel_for(outcomes.size(), threads, [&](std::size_t a) {
    if (progress.cancelled()) return;
    outcomes[a] = keep_plane(samples, region, step, static_cast<std::int32_t>(a), *writer);
  });
  for (Result<void>& outcome : outcomes)
    if (!outcome) return std::move(outcome).error();
  if (progress.cancelled()) return Error{ErrorCode::cancelled, "thinning out a volume was cancelled"};
  auto coarse = std::move(*writer).finish(threads, progress);
  if (!coarse) return std::move(coarse).error();
  return CoarseVolume{region.first, step, *std::move(coarse)};
}

}  // namespace geosis
