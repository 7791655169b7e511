#pragma once

#include <cstddef>
#include <cstdint>

#include "engine/base/result.h"
#include "engine/volume/bricks.h"
#include "engine/volume/grid.h"

namespace geosis {

/// Longest axis: positions on the lattice of 1/64 voxel up to 131071 + 1 are exact in float32.
inline constexpr std::int32_t kMaxAxisNodes = 131071;

/// errors: invalid_argument (an axis without nodes), limit_exceeded (an axis longer than kMaxAxisNodes).
Result<void> check_axes(GridShape shape);

/// Bricks along one axis, first and last.
struct BrickSpan {
  std::int32_t first = 0, last = 0;
};

/// Those of an axis' `bricks` that hold the node: one, or two on a shared layer.
BrickSpan bricks_with(std::int32_t node, std::int32_t bricks);

/// Where the bricks of a volume lie: on the grid, and one after the other in storage. Pure arithmetic, O(1) each.
///
/// An axis of n nodes has g = max(1, ceil((n - 1) / 63)) bricks, which store n + g - 1 layers (shared layers twice), so
/// that all places follow from the shape alone. The shape has passed check_axes.
class BrickLayout {
 public:
  BrickLayout() = default;
  explicit BrickLayout(GridShape shape);

  GridShape shape() const { return shape_; }
  GridShape grid() const { return grid_; }
  std::size_t brick_count() const { return static_cast<std::size_t>(grid_.count()); }
  std::size_t number(GridIndex place) const;
  GridIndex place(std::size_t brick) const;
  GridIndex first_node(GridIndex place) const;
  GridShape extent(GridIndex place) const;
  /// Samples stored before this brick's.
  std::uint64_t sample_offset(GridIndex place) const;
  /// Samples stored in all bricks.
  std::uint64_t stored_samples() const;

 private:
  GridShape shape_, grid_;
};

}  // namespace geosis
