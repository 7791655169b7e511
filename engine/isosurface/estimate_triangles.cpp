#include "engine/isosurface/estimate_triangles.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/isosurface/brick_sweep.h"
#include "engine/volume/brick_layout.h"

namespace geosis {
namespace {

/// Triangles of a sheet in a block of 4096 cells, where it passes all neighbours and lies in the middle of the values.
constexpr double kTrianglesPerBlock = 1400;
constexpr double kCellsPerBlock = 1.0 * kBlockCells * kBlockCells * kBlockCells;
constexpr double kTrianglesPerCapFace = 2;
/// For a value that is a block's least or greatest itself, as in volumes of few distinct values.
constexpr double kTieWeight = 0.7;

/// The blocks along one axis that hold cells of the region.
struct AxisBlock {
  std::int32_t brick = 0, block = 0;  ///< place of its brick; its own place in the brick
  std::int32_t cells = 0;             ///< in the region
  int region_ends = 0;                ///< of the region at this block: 0, 1 or 2
};

std::vector<AxisBlock> blocks_of_axis(std::int32_t nodes, std::int32_t first, std::int32_t last) {
  std::vector<AxisBlock> blocks;
  const std::int32_t cells = nodes - 1;
  for (std::int32_t brick = 0; brick * kBrickCells < cells; ++brick) {
    const std::int32_t start = brick * kBrickCells, end = std::min(start + kBrickCells, cells);
    for (std::int32_t block = 0; block < kBlocksPerAxis; ++block) {
      const std::int32_t from = std::max(start + block * kBlockCells, first);
      const std::int32_t to = std::min({start + (block + 1) * kBlockCells, end, last});
      if (from < to) blocks.push_back({brick, block, to - from, (from == first) + (to == last)});
    }
  }
  return blocks;
}

/// All blocks of a region, addressed by their places along the axes.
class RegionBlocks {
 public:
  RegionBlocks(const BrickedVolume& volume, const GridBox& region) : volume_(volume), layout_(volume.shape()) {
    for (int axis = 0; axis < 3; ++axis) {
      axes_[axis] = blocks_of_axis(volume.shape()[axis], region.first[axis], region.last[axis]);
    }
  }

  std::int32_t count(int axis) const { return static_cast<std::int32_t>(axes_[axis].size()); }
  const AxisBlock& block(int axis, GridIndex place) const { return axes_[axis][static_cast<std::size_t>(place[axis])]; }
  double cells(GridIndex place) const {
    return 1.0 * block(0, place).cells * block(1, place).cells * block(2, place).cells;
  }
  ValueRange range(GridIndex place) const {
    const AxisBlock &i = block(0, place), &j = block(1, place), &k = block(2, place);
    const std::size_t brick = layout_.number({i.brick, j.brick, k.brick});
    const int number = (i.block * kBlocksPerAxis + j.block) * kBlocksPerAxis + k.block;
    return volume_.block_ranges(brick)[static_cast<std::size_t>(number)];
  }

 private:
  const BrickedVolume& volume_;
  BrickLayout layout_;
  std::array<std::vector<AxisBlock>, 3> axes_;
};

/// One of the two sheets of a body: low counts as inside, and so does high.
struct Sheet {
  float value;
  bool is_low;

  bool passes(ValueRange range) const {
    return is_low ? range.min < value && value <= range.max : range.min <= value && value < range.max;
  }
  double weight(ValueRange range) const {
    const double t = (double{value} - range.min) / (double{range.max} - range.min);
    return t <= 0 || t >= 1 ? kTieWeight : 2 * std::sqrt(t * (1 - t));
  }
};

/// Share of the block's neighbours that the sheet passes; 1 where it has none.
double neighbours_passed(const RegionBlocks& blocks, GridIndex place, const Sheet& sheet) {
  int neighbours = 0, passed = 0;
  for (int side = 0; side < 6; ++side) {
    GridIndex next = place;
    next[side / 2] += side % 2 == 0 ? 1 : -1;
    if (next[side / 2] < 0 || next[side / 2] >= blocks.count(side / 2)) continue;
    const ValueRange range = blocks.range(next);
    if (range.min > range.max) continue;
    ++neighbours;
    if (sheet.passes(range)) ++passed;
  }
  return neighbours == 0 ? 1 : static_cast<double>(passed) / neighbours;
}

double sheet_triangles(const RegionBlocks& blocks, GridIndex place, ValueRange range, const Sheet& sheet) {
  if (!std::isfinite(sheet.value) || !sheet.passes(range)) return 0;
  const double share = blocks.cells(place) / kCellsPerBlock;
  return kTrianglesPerBlock * share * sheet.weight(range) * neighbours_passed(blocks, place, sheet);
}

/// Share of a block's values in the range, as if they were spread evenly.
double share_inside(ValueRange values, IsoRange range) {
  const double low = std::max(values.min, range.low), high = std::min(values.max, range.high);
  if (low > high) return 0;
  return values.max > values.min ? (high - low) / (double{values.max} - values.min) : 1;
}

/// Triangles that close the body on the region's faces.
double cap_triangles(const RegionBlocks& blocks, GridIndex place, ValueRange values, IsoRange range) {
  double faces = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const AxisBlock& block = blocks.block(axis, place);
    faces += block.region_ends * blocks.cells(place) / block.cells;
  }
  return faces == 0 ? 0 : kTrianglesPerCapFace * faces * share_inside(values, range);
}

}  // namespace

double estimate_triangles(const BrickedVolume& volume, IsoRange range, const ExtractOptions& options) {
  if (!check_request(volume.shape(), range, options)) return 0;
  const RegionBlocks blocks(volume, options.region);
  const Sheet low{range.low, true}, high{range.high, false};
  double triangles = 0;
  GridIndex place;
  for (place.i = 0; place.i < blocks.count(0); ++place.i) {
    for (place.j = 0; place.j < blocks.count(1); ++place.j) {
      for (place.k = 0; place.k < blocks.count(2); ++place.k) {
        const ValueRange values = blocks.range(place);
        if (values.min > values.max) continue;
        triangles += sheet_triangles(blocks, place, values, low) + sheet_triangles(blocks, place, values, high);
        if (options.cap) triangles += cap_triangles(blocks, place, values, range);
      }
    }
  }
  return triangles;
}

}  // namespace geosis
