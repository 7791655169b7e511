#include "engine/missing/file/fill_writer.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

#include <xxhash.h>

#include "engine/missing/file/fill_image.h"

namespace geosis {
namespace {

void include(ValueRange& range, float value) {
  range.min = std::min(range.min, value);
  range.max = std::max(range.max, value);
}

/// Blocks along an axis of n samples that hold the sample: two where blocks meet.
struct BlockSpan {
  std::int32_t first, last;
};
BlockSpan blocks_with(std::int32_t sample, std::int32_t n) {
  const std::int32_t last_block = std::max(n - 2, 0) / kBlockCells;
  const std::int32_t upper = sample / kBlockCells;
  return {sample % kBlockCells == 0 && sample > 0 ? upper - 1 : upper, std::min(upper, last_block)};
}

void include(std::span<ValueRange, kBlocksPerBrick> blocks, const std::array<BlockSpan, 3>& with, float value) {
  for (std::int32_t a = with[0].first; a <= with[0].last; ++a)
    for (std::int32_t b = with[1].first; b <= with[1].last; ++b)
      for (std::int32_t c = with[2].first; c <= with[2].last; ++c)
        include(blocks[(static_cast<std::size_t>(a) * kBlocksPerAxis + b) * kBlocksPerAxis + c], value);
}

}  // namespace

Result<FillWriter> FillWriter::create(const BrickedVolume& volume, std::span<const std::uint32_t> counts,
                                      const std::optional<std::filesystem::path>& path) {
  const FillFilePlan plan =
      plan_fill_file(volume.shape(), std::accumulate(counts.begin(), counts.end(), std::uint64_t{0}));
  auto file = NewFile::create(path, plan.file_bytes);
  if (!file) return std::move(file).error();
  FillWriter writer(volume, plan, *std::move(file));
  std::uint64_t first = 0;
  for (std::size_t brick = 0; brick < counts.size(); ++brick) {
    StoredFill& summary = writer.summaries()[brick];
    summary.first = first;
    summary.count = counts[brick];
    first += counts[brick];
  }
  return writer;
}

StoredFill* FillWriter::summaries() {
  return reinterpret_cast<StoredFill*>(file_.writable().data() + plan_.summaries_at);
}

std::span<FilledSample> FillWriter::records(std::size_t brick) {
  const StoredFill& summary = summaries()[brick];
  auto* records = reinterpret_cast<FilledSample*>(file_.writable().data() + plan_.records_at);
  return {records + summary.first, summary.count};
}

FilledSample* FillWriter::find(GridIndex node) {
  const GridShape grid = plan_.layout.grid();
  const GridIndex place{std::min(node.i / kBrickCells, grid.inlines - 1),
                        std::min(node.j / kBrickCells, grid.crosslines - 1),
                        std::min(node.k / kBrickCells, grid.samples - 1)};
  const GridIndex first = plan_.layout.first_node(place);
  const GridShape extent = plan_.layout.extent(place);
  const auto sample = static_cast<std::uint32_t>(
      ((node.i - first.i) * extent.crosslines + (node.j - first.j)) * extent.samples + (node.k - first.k));
  const auto own = records(plan_.layout.number(place));
  const auto found = std::ranges::lower_bound(own, sample, {}, &FilledSample::place);
  return found != own.end() && found->place == sample ? &*found : nullptr;
}

void FillWriter::index(std::size_t brick, bool has_missing) {
  StoredFill& summary = summaries()[brick];
  auto* stored = reinterpret_cast<ValueRange*>(file_.writable().data() + plan_.block_ranges_at);
  const std::span<ValueRange, kBlocksPerBrick> blocks(stored + brick * kBlocksPerBrick, kBlocksPerBrick);
  const GridShape extent = plan_.layout.extent(plan_.layout.place(brick));
  summary.range = volume_.summary(brick).range;
  std::ranges::copy(volume_.block_ranges(brick), blocks.begin());
  const auto own = records(brick);
  for (const FilledSample& record : own) {
    const auto place = static_cast<std::int32_t>(record.place);
    const std::int32_t row = place / extent.samples;
    include(summary.range, record.value);
    include(
        blocks,
        {blocks_with(row / extent.crosslines, extent.inlines), blocks_with(row % extent.crosslines, extent.crosslines),
         blocks_with(place % extent.samples, extent.samples)},
        record.value);
  }
  if (has_missing) summary.flags |= kFillHasMissing;
  if (volume_.summary(brick).all_missing && own.empty()) summary.flags |= kFillAllMissing;
  summary.checksum = XXH3_64bits(own.data(), own.size_bytes());
}

Result<std::unique_ptr<FilledVolume>> FillWriter::finish(std::uint64_t filled_nodes) && {
  plan_.filled_nodes = filled_nodes;
  write_fill_header(plan_, index_checksum(volume_), file_.writable());
  auto published = std::move(file_).publish();
  if (!published) return std::move(published).error();
  const std::shared_ptr<const MappedFile> owner = *std::move(published);
  return std::unique_ptr<FilledVolume>(std::make_unique<FillImage>(volume_, owner, owner->bytes(), plan_));
}

}  // namespace geosis
