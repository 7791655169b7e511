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
constexpr std::size_t kLanes = 8;

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

// Sixteen samples in lanes that do not depend on each other: the order is fixed and the compiler may use vectors.
ValueRange range_of_sixteen(const float* samples) {
  std::array<float, kLanes> low, high;
  for (std::size_t l = 0; l < kLanes; ++l) {
    low[l] = samples[l] < kEmpty.min ? samples[l] : kEmpty.min;
    high[l] = samples[l] > kEmpty.max ? samples[l] : kEmpty.max;
  }
  for (std::size_t l = 0; l < kLanes; ++l) {
    low[l] = samples[kLanes + l] < low[l] ? samples[kLanes + l] : low[l];
    high[l] = samples[kLanes + l] > high[l] ? samples[kLanes + l] : high[l];
  }
  ValueRange range = kEmpty;
  for (std::size_t l = 0; l < kLanes; ++l) include(range, ValueRange{low[l], high[l]});
  return range;
}

// Ranges of the blocks along one row of n samples; a block without cells stays empty, but the first one always counts.
BlockRow ranges_along(const float* row, std::int32_t n) {
  BlockRow ranges;
  ranges.fill(kEmpty);
  for (std::int32_t c = 0; c == 0 || c * kBlockCells < n - 1; ++c) {
    const std::int32_t begin = c * kBlockCells;
    ValueRange& range = ranges[static_cast<std::size_t>(c)];
    std::int32_t k = begin;
    if (begin + kBlockCells <= n) {
      range = range_of_sixteen(row + begin);
      k = begin + kBlockCells;
    }
    for (; k < n && k <= begin + kBlockCells; ++k) include(range, row[k]);
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
  for (std::size_t begin = 0; begin < samples.size(); begin += length, ++rows_) {
    const BlockSpan along_i = blocks_at(static_cast<std::int32_t>(rows_ / extent_.crosslines), extent_.inlines);
    const BlockSpan along_j = blocks_at(static_cast<std::int32_t>(rows_ % extent_.crosslines), extent_.crosslines);
    const BlockRow ranges = ranges_along(samples.data() + begin, extent_.samples);
    for (std::int32_t p = along_i.first; p <= along_i.last; ++p)
      for (std::int32_t q = along_j.first; q <= along_j.last; ++q)
        for (std::int32_t c = 0; c < kBlocksPerAxis; ++c)
          include(blocks_[static_cast<std::size_t>((p * kBlocksPerAxis + q) * kBlocksPerAxis + c)],
                  ranges[static_cast<std::size_t>(c)]);
  }
  missing_ += static_cast<std::int64_t>(count_missing(samples));
  XXH3_64bits_update(checksum_.get(), samples.data(), samples.size_bytes());
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
