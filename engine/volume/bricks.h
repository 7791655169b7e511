#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <span>

#include "engine/base/result.h"
#include "engine/volume/grid.h"

namespace geosis {

/// A brick holds up to 64 x 64 x 64 samples, which are the corners of 63 x 63 x 63 cells; neighbours share one layer
/// of samples. The last brick of an axis is clipped.
inline constexpr std::int32_t kBrickSamples = 64;
inline constexpr std::int32_t kBrickCells = 63;
/// Inside a brick, the index also covers blocks of 16 x 16 x 16 cells (17 samples an axis): 4 x 4 x 4 a brick.
inline constexpr std::int32_t kBlockCells = 16;
inline constexpr std::int32_t kBlocksPerAxis = 4;
inline constexpr std::int32_t kBlocksPerBrick = 64;

/// Smallest and largest valid sample of a box. Without a valid sample: min = +inf, max = -inf.
struct ValueRange {
  float min = 0, max = 0;
};

struct BrickSummary {
  ValueRange range;
  bool has_missing = false;  ///< at least one sample is NaN
  bool all_missing = false;
};

/// Samples of one brick, row after row: sample (a, b, c) of the brick at samples[(a * extent.crosslines + b) *
/// extent.samples + c]; its node in the volume is first + (a, b, c). Missing samples are NaN. Finite or NaN, never
/// infinite.
struct BrickView {
  const float* samples = nullptr;
  GridIndex first;
  GridShape extent;
  std::shared_ptr<const void> owner = nullptr;  ///< keeps samples alive that were put together for this view
};

/// A volume cut into bricks, with its min/max index: what extraction reads. Immutable; any thread may read it.
///
/// It is an image of the brick file (docs/formats/brick-file.md), mapped from disk or held in memory.
class BrickedVolume {
 public:
  virtual ~BrickedVolume() = default;

  virtual GridShape shape() const = 0;
  /// Number of bricks along each axis: ceil((n - 1) / 63), at least 1.
  virtual GridShape brick_grid() const = 0;
  /// Bricks are numbered with the sample axis fastest: (bi * grid.crosslines + bj) * grid.samples + bk.
  virtual std::size_t brick_count() const = 0;
  virtual BrickSummary summary(std::size_t brick) const = 0;
  /// 64 block ranges of the brick, block (a, b, c) at (a * 4 + b) * 4 + c; blocks outside a clipped brick are empty.
  virtual std::span<const ValueRange, kBlocksPerBrick> block_ranges(std::size_t brick) const = 0;
  /// Checks the brick's checksum at first touch. errors: malformed_input (damaged brick).
  virtual Result<BrickView> brick(std::size_t brick) const = 0;
};

/// Whether any sample of the volume is missing, by its index alone.
inline bool has_missing(const BrickedVolume& volume) {
  for (std::size_t brick = 0; brick < volume.brick_count(); ++brick) {
    if (volume.summary(brick).has_missing) return true;
  }
  return false;
}

/// Smallest and largest valid sample of the volume, by its index alone.
inline ValueRange value_range(const BrickedVolume& volume) {
  ValueRange all{std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity()};
  for (std::size_t brick = 0; brick < volume.brick_count(); ++brick) {
    const ValueRange range = volume.summary(brick).range;
    all = {std::min(all.min, range.min), std::max(all.max, range.max)};
  }
  return all;
}

}  // namespace geosis
