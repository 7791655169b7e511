#include "engine/volume/brick_store.h"

#include <algorithm>
#include <atomic>
#include <cstring>

#include "engine/base/parallel.h"
#include "engine/volume/brick_index.h"

namespace geosis {
namespace {

float* samples_of(std::span<std::byte> file, const BrickFilePlan& plan, GridIndex place) {
  return reinterpret_cast<float*>(file.data() + plan.samples_at) + plan.layout.sample_offset(place);
}

// The part of the samples that one brick holds; nothing when it holds none.
void store_in_brick(std::span<std::byte> file, const BrickFilePlan& plan, GridIndex place, GridIndex node,
                    std::span<const float> samples) {
  const GridIndex first = plan.layout.first_node(place);
  const GridShape extent = plan.layout.extent(place);
  const std::int32_t from = std::max(first.k, node.k);
  const std::int32_t end = node.k + static_cast<std::int32_t>(samples.size());
  const std::int32_t count = std::min(first.k + extent.samples, end) - from;
  if (count <= 0) return;
  const std::ptrdiff_t row = std::ptrdiff_t{node.i - first.i} * extent.crosslines + (node.j - first.j);
  std::memcpy(samples_of(file, plan, place) + row * extent.samples + (from - first.k), samples.data() + (from - node.k),
              static_cast<std::size_t>(count) * sizeof(float));
}

void store_in_column(std::span<std::byte> file, const BrickFilePlan& plan, GridIndex place, GridIndex node,
                     std::span<const float> samples) {
  const std::int32_t end = node.k + static_cast<std::int32_t>(samples.size());
  for (place.k = bricks_with(node.k, plan.layout.grid().samples).first; place.k < plan.layout.grid().samples;
       ++place.k) {
    if (plan.layout.first_node(place).k >= end) break;
    store_in_brick(file, plan, place, node, samples);
  }
}

}  // namespace

void store_samples(std::span<std::byte> file, const BrickFilePlan& plan, std::int32_t i, std::int32_t j,
                   std::int32_t k0, std::span<const float> samples) {
  const BrickSpan along_i = bricks_with(i, plan.layout.grid().inlines);
  const BrickSpan along_j = bricks_with(j, plan.layout.grid().crosslines);
  for (std::int32_t bi = along_i.first; bi <= along_i.last; ++bi)
    for (std::int32_t bj = along_j.first; bj <= along_j.last; ++bj)
      store_in_column(file, plan, {bi, bj, 0}, {i, j, k0}, samples);
}

void index_stored_brick(std::span<std::byte> file, const BrickFilePlan& plan, std::size_t brick) {
  auto* summaries = reinterpret_cast<StoredSummary*>(file.data() + plan.summaries_at);
  auto* blocks = reinterpret_cast<ValueRange*>(file.data() + plan.block_ranges_at);
  const GridIndex place = plan.layout.place(brick);
  const GridShape extent = plan.layout.extent(place);
  const std::span<const float> samples(samples_of(file, plan, place), static_cast<std::size_t>(extent.count()));
  summaries[brick] = index_brick(
      samples, extent, std::span<ValueRange, kBlocksPerBrick>(blocks + brick * kBlocksPerBrick, kBlocksPerBrick));
}

bool index_file(std::span<std::byte> file, const BrickFilePlan& plan, std::span<const std::uint8_t> indexed,
                int threads, Progress& progress) {
  const std::size_t bricks = plan.layout.brick_count();
  std::atomic<std::size_t> done = 0;
  parallel_for(bricks, threads, [&](std::size_t brick) {
    if (progress.cancelled()) return;
    if (indexed.empty() || !indexed[brick]) index_stored_brick(file, plan, brick);
    progress.report("index", static_cast<double>(++done) / static_cast<double>(bricks));
  });
  if (progress.cancelled()) return false;
  write_brick_header(plan, file);
  return true;
}

}  // namespace geosis
