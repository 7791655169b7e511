#include "engine/volume/brick_index.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace geosis {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kMissing = std::numeric_limits<float>::quiet_NaN();

/// The range of the samples of one block, looked up one by one; empty for blocks without cells.
ValueRange brute_force(const std::vector<float>& samples, GridShape extent, GridIndex block) {
  ValueRange range{kInfinity, -kInfinity};
  const auto has_cells = [](std::int32_t b, std::int32_t n) { return b == 0 || b * kBlockCells < n - 1; };
  if (!has_cells(block.i, extent.inlines) || !has_cells(block.j, extent.crosslines) ||
      !has_cells(block.k, extent.samples))
    return range;
  const auto end = [](std::int32_t b, std::int32_t n) { return std::min((b + 1) * kBlockCells + 1, n); };
  for (std::int32_t i = block.i * kBlockCells; i < end(block.i, extent.inlines); ++i)
    for (std::int32_t j = block.j * kBlockCells; j < end(block.j, extent.crosslines); ++j)
      for (std::int32_t k = block.k * kBlockCells; k < end(block.k, extent.samples); ++k) {
        const float value = samples[static_cast<std::size_t>((i * extent.crosslines + j) * extent.samples + k)];
        if (!std::isnan(value)) range = {std::min(range.min, value), std::max(range.max, value)};
      }
  return range;
}

TEST(IndexBrick, EqualsBruteForce) {
  constexpr unsigned seed = 20;
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  for (const GridShape extent :
       {GridShape{64, 64, 64}, {2, 2, 2}, {17, 18, 33}, {16, 49, 64}, {64, 5, 63}, {1, 2, 17}}) {
    std::vector<float> samples(static_cast<std::size_t>(extent.count()));
    for (float& value : samples) value = random() % 5 == 0 ? kMissing : static_cast<float>(random() % 100000) - 5e4f;
    std::array<ValueRange, kBlocksPerBrick> blocks;
    const StoredSummary summary = index_brick(samples, extent, blocks);
    ValueRange whole{kInfinity, -kInfinity};
    for (int b = 0; b < kBlocksPerBrick; ++b) {
      const ValueRange expected = brute_force(samples, extent, {b / 16, b / 4 % 4, b % 4});
      const ValueRange& actual = blocks[static_cast<std::size_t>(b)];
      EXPECT_EQ(actual.min, expected.min) << "block " << b << " of " << extent.samples;
      EXPECT_EQ(actual.max, expected.max) << "block " << b << " of " << extent.samples;
      whole = {std::min(whole.min, expected.min), std::max(whole.max, expected.max)};
    }
    EXPECT_EQ(summary.range.min, whole.min);
    EXPECT_EQ(summary.range.max, whole.max);
  }
}

TEST(IndexBrick, KnowsMissingSamples) {
  std::array<ValueRange, kBlocksPerBrick> blocks;
  std::vector<float> samples(27, 1.0f);
  EXPECT_EQ(index_brick(samples, {3, 3, 3}, blocks).flags, 0u);
  samples[26] = kMissing;
  EXPECT_EQ(index_brick(samples, {3, 3, 3}, blocks).flags, kHasMissing);
  std::fill(samples.begin(), samples.end(), kMissing);
  const StoredSummary all = index_brick(samples, {3, 3, 3}, blocks);
  EXPECT_EQ(all.flags, kHasMissing | kAllMissing);
  EXPECT_EQ(all.range.min, kInfinity);
  EXPECT_EQ(all.range.max, -kInfinity);
}

}  // namespace
}  // namespace geosis
