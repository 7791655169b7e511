#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "engine/base/result.h"
#include "engine/volume/brick_layout.h"
#include "engine/volume/bricks.h"

namespace geosis {

/// Samples of a volume by node: views of its bricks, held for as long as they are needed.
class BrickViews {
 public:
  explicit BrickViews(const BrickedVolume& volume) : layout_(volume.shape()), views_(layout_.brick_count()) {}

  /// Takes a brick's view, once, before its samples are asked for. Different bricks may be taken at once.
  Result<void> take(const BrickedVolume& volume, std::size_t brick) {
    auto view = volume.brick(brick);
    if (!view) return std::move(view).error();
    views_[brick] = *std::move(view);
    return {};
  }

  const BrickLayout& layout() const { return layout_; }
  const BrickView& view(std::size_t brick) const { return views_[brick]; }
  /// The samples of a trace that a layer of bricks holds.
  const float* row(std::int32_t i, std::int32_t j, std::int32_t brick_k) const {
    const GridShape grid = layout_.grid();
    const std::int32_t bi = std::min(i / kBrickCells, grid.inlines - 1);
    const std::int32_t bj = std::min(j / kBrickCells, grid.crosslines - 1);
    const BrickView& brick = views_[(static_cast<std::size_t>(bi) * grid.crosslines + bj) * grid.samples + brick_k];
    const std::int32_t trace = (i - brick.first.i) * brick.extent.crosslines + (j - brick.first.j);
    return brick.samples + static_cast<std::ptrdiff_t>(trace) * brick.extent.samples;
  }
  float at(GridIndex node) const {
    const std::int32_t brick_k = std::min(node.k / kBrickCells, layout_.grid().samples - 1);
    return row(node.i, node.j, brick_k)[node.k - brick_k * kBrickCells];
  }

 private:
  BrickLayout layout_;
  std::vector<BrickView> views_;
};

}  // namespace geosis
