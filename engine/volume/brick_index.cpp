#include "engine/volume/brick_index.h"

#include <array>
#include <cstddef>
#include <limits>

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

StoredSummary index_brick(std::span<const float> samples, GridShape extent,
                          std::span<ValueRange, kBlocksPerBrick> blocks) {
  for (ValueRange& range : blocks) range = kEmpty;
  const float* row = samples.data();
  for (std::int32_t a = 0; a < extent.inlines; ++a) {
    const BlockSpan along_i = blocks_at(a, extent.inlines);
    for (std::int32_t b = 0; b < extent.crosslines; ++b, row += extent.samples) {
      const BlockSpan along_j = blocks_at(b, extent.crosslines);
      const BlockRow ranges = ranges_along(row, extent.samples);
      for (std::int32_t p = along_i.first; p <= along_i.last; ++p)
        for (std::int32_t q = along_j.first; q <= along_j.last; ++q)
          for (std::int32_t c = 0; c < kBlocksPerAxis; ++c)
            include(blocks[static_cast<std::size_t>((p * kBlocksPerAxis + q) * kBlocksPerAxis + c)],
                    ranges[static_cast<std::size_t>(c)]);
    }
  }

  StoredSummary summary;
  summary.range = kEmpty;
  for (const ValueRange& range : blocks) include(summary.range, range);
  const std::size_t missing = count_missing(samples);
  summary.flags = (missing > 0 ? kHasMissing : 0) | (missing == samples.size() ? kAllMissing : 0);
  summary.checksum = XXH3_64bits(samples.data(), samples.size_bytes());
  return summary;
}

}  // namespace geosis
