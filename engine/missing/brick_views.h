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
  /// The brick that a node belongs to; on a shared layer, the one that begins there.
  std::size_t brick_of(GridIndex node) const {
    const GridShape grid = layout_.grid();
    return layout_.number({std::min(node.i / kBrickCells, grid.inlines - 1),
                           std::min(node.j / kBrickCells, grid.crosslines - 1),
                           std::min(node.k / kBrickCells, grid.samples - 1)});
  }
  float at(GridIndex node) const {
    const BrickView& brick = views_[brick_of(node)];
    const std::size_t row =
        static_cast<std::size_t>(node.i - brick.first.i) * brick.extent.crosslines + (node.j - brick.first.j);
    return brick.samples[row * brick.extent.samples + (node.k - brick.first.k)];
  }

 private:
  BrickLayout layout_;
  std::vector<BrickView> views_;
};

}  // namespace geosis
