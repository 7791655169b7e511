#include "engine/volume/sample_box.h"

#include <algorithm>
#include <cstring>

#include "engine/volume/brick_layout.h"

namespace geosis {
namespace {

/// Bricks along one axis that hold a node of [first, last].
BrickSpan bricks_over(std::int32_t first, std::int32_t last, std::int32_t bricks) {
  return {std::min(first / kBrickCells, bricks - 1), std::min(last / kBrickCells, bricks - 1)};
}

/// The nodes that brick and box share, row by row. Layers that several bricks hold are the same in each.
void copy_shared(const BrickView& brick, SampleBox& box) {
  std::int32_t from[3], to[3];
  for (int axis = 0; axis < 3; ++axis) {
    from[axis] = std::max(brick.first[axis], box.first[axis]);
    to[axis] = std::min(brick.first[axis] + brick.extent[axis], box.first[axis] + box.shape[axis]);
    if (from[axis] >= to[axis]) return;
  }
  const auto bytes = static_cast<std::size_t>(to[2] - from[2]) * sizeof(float);
  for (std::int32_t i = from[0]; i < to[0]; ++i) {
    for (std::int32_t j = from[1]; j < to[1]; ++j) {
      const std::size_t row =
          static_cast<std::size_t>(i - brick.first.i) * brick.extent.crosslines + (j - brick.first.j);
      std::memcpy(&box.value[box.at(i - box.first.i, j - box.first.j, from[2] - box.first.k)],
                  brick.samples + row * brick.extent.samples + (from[2] - brick.first.k), bytes);
    }
  }
}

}  // namespace

Result<SampleBox> read_box(const BrickedVolume& volume, const GridBox& box) {
  SampleBox result{
      box.first, {box.last.i - box.first.i + 1, box.last.j - box.first.j + 1, box.last.k - box.first.k + 1}, {}};
  result.value.resize(static_cast<std::size_t>(result.shape.count()));
  const BrickLayout layout(volume.shape());
  BrickSpan span[3];
  for (int axis = 0; axis < 3; ++axis) span[axis] = bricks_over(box.first[axis], box.last[axis], layout.grid()[axis]);
  for (std::int32_t bi = span[0].first; bi <= span[0].last; ++bi) {
    for (std::int32_t bj = span[1].first; bj <= span[1].last; ++bj) {
      for (std::int32_t bk = span[2].first; bk <= span[2].last; ++bk) {
        const auto brick = volume.brick(layout.number({bi, bj, bk}));
        if (!brick) return brick.error();
        copy_shared(*brick, result);
      }
    }
  }
  return result;
}

}  // namespace geosis
