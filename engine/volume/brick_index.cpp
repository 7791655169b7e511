#include "engine/volume/brick_index.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <new>

#include <xxhash.h>

namespace geosis {
namespace {

constexpr ValueRange kEmpty{std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity()};
using BlockRow = std::array<ValueRange, kBlocksPerAxis>;

// NaN never wins a comparison, so missing samples fall out by themselves.
void include(ValueRange& range, float value) {
  range.min = value < range.min ? value : range.min;
  range.max = value > range.max ? value : range.max;
}

void include(ValueRange& range, const ValueRange& other) {
  range.min = other.min < range.min ? other.min : range.min;
  range.max = other.max > range.max ? other.max : range.max;
}

/// Ranges at each sample of the rows of some blocks: rows go in as vectors, and only the end looks along them.
struct Envelope {
  std::array<float, kBrickCells + 1> min, max;

  explicit Envelope(std::size_t length) {
    std::fill_n(min.begin(), length, kEmpty.min);
    std::fill_n(max.begin(), length, kEmpty.max);
  }
  void add_row(const float* row, std::size_t length) {
    for (std::size_t k = 0; k < length; ++k) {
      const float value = row[k];
      min[k] = value < min[k] ? value : min[k];
      max[k] = value > max[k] ? value : max[k];
    }
  }
};

// Ranges of the blocks along rows of n samples; a block without cells stays empty, but the first one always counts.
BlockRow ranges_along(const Envelope& rows, std::int32_t n) {
  BlockRow ranges;
  ranges.fill(kEmpty);
  for (std::int32_t c = 0; c == 0 || c * kBlockCells < n - 1; ++c) {
    const std::int32_t begin = c * kBlockCells;
    for (std::int32_t k = begin; k < n && k <= begin + kBlockCells; ++k) {
      const auto at = static_cast<std::size_t>(k);
      include(ranges[static_cast<std::size_t>(c)], ValueRange{rows.min[at], rows.max[at]});
    }
  }
  return ranges;
}

std::size_t count_missing(std::span<const float> samples) {
  std::size_t missing = 0;
  for (const float value : samples) missing += value != value;
  return missing;
}

// Blocks of one axis that the layer at `position` of n belongs to: one, or two where blocks meet.
struct BlockSpan {
  std::int32_t first, last;
  bool operator==(const BlockSpan&) const = default;
};
BlockSpan blocks_at(std::int32_t position, std::int32_t n) {
  const std::int32_t last_block = n < 2 ? 0 : (n - 2) / kBlockCells;
  const std::int32_t upper = position / kBlockCells;
  const bool shared = position % kBlockCells == 0 && position > 0;
  return {shared ? upper - 1 : upper, upper < last_block ? upper : last_block};
}

}  // namespace

void BrickIndexer::FreeChecksum::operator()(XXH3_state_s* checksum) const {
  XXH3_freeState(checksum);
}

BrickIndexer::BrickIndexer(GridShape extent, std::span<ValueRange, kBlocksPerBrick> blocks)
    : extent_(extent), blocks_(blocks), checksum_(XXH3_createState()) {
  if (!checksum_) throw std::bad_alloc();
  XXH3_64bits_reset(checksum_.get());
  std::fill(blocks.begin(), blocks.end(), kEmpty);
}

void BrickIndexer::add_rows(std::span<const float> samples) {
  const auto length = static_cast<std::size_t>(extent_.samples);
  for (auto left = samples; !left.empty();) left = left.subspan(add_rows_of_same_blocks(left) * length);
  missing_ += static_cast<std::int64_t>(count_missing(samples));
  XXH3_64bits_update(checksum_.get(), samples.data(), samples.size_bytes());
}

std::size_t BrickIndexer::add_rows_of_same_blocks(std::span<const float> samples) {
  const auto length = static_cast<std::size_t>(extent_.samples);
  const std::size_t rows = samples.size() / length;
  const std::int64_t crosslines = extent_.crosslines;
  const BlockSpan along_i = blocks_at(static_cast<std::int32_t>(rows_ / crosslines), extent_.inlines);
  auto j = static_cast<std::int32_t>(rows_ % crosslines);
  const BlockSpan along_j = blocks_at(j, extent_.crosslines);
  Envelope envelope(length);
  std::size_t count = 0;
  for (; count < rows && j < crosslines && blocks_at(j, extent_.crosslines) == along_j; ++count, ++j)
    envelope.add_row(samples.data() + count * length, length);
  const BlockRow ranges = ranges_along(envelope, extent_.samples);
  for (std::int32_t p = along_i.first; p <= along_i.last; ++p)
    for (std::int32_t q = along_j.first; q <= along_j.last; ++q)
      for (std::int32_t c = 0; c < kBlocksPerAxis; ++c)
        include(blocks_[static_cast<std::size_t>((p * kBlocksPerAxis + q) * kBlocksPerAxis + c)],
                ranges[static_cast<std::size_t>(c)]);
  rows_ += static_cast<std::int64_t>(count);
  return count;
}

StoredSummary BrickIndexer::summary() const {
  StoredSummary summary;
  summary.range = kEmpty;
  for (const ValueRange& range : blocks_) include(summary.range, range);
  summary.flags = (missing_ > 0 ? kHasMissing : 0) | (missing_ == extent_.count() ? kAllMissing : 0);
  summary.checksum = XXH3_64bits_digest(checksum_.get());
  return summary;
}

StoredSummary index_brick(std::span<const float> samples, GridShape extent,
                          std::span<ValueRange, kBlocksPerBrick> blocks) {
  BrickIndexer indexer(extent, blocks);
  indexer.add_rows(samples);
  return indexer.summary();
}

}  // namespace geosis
