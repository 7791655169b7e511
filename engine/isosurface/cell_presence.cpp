#include "engine/isosurface/cell_presence.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/volume/brick_layout.h"

namespace geosis {
namespace {

constexpr int kNodes = kBrickSamples + 2;  // nodes -1 .. 64: the corners of cells -1 .. 63

/// Validity of nodes -1 .. 64 of one row along the sample axis: three pieces, from up to three bricks.
struct NodeRow {
  std::uint64_t nodes = ~std::uint64_t{0};  // 0 .. 63
  bool before = true, after = true;         // -1 and 64; outside the volume counts as valid, the region decides there
};

/// Reads single samples near a brick, through whichever brick holds them.
class NodeReader {
 public:
  explicit NodeReader(const BrickedVolume& volume) : volume_(volume), layout_(volume.shape()) {}

  Result<NodeRow> row(GridIndex start) {
    NodeRow row;
    const GridShape shape = volume_.shape();
    if (start.i < 0 || start.j < 0 || start.i >= shape.inlines || start.j >= shape.crosslines) return row;
    if (auto done = read(start, row.nodes, kBrickSamples); !done) return done.error();
    std::uint64_t single = 1;
    if (auto done = read({start.i, start.j, start.k - 1}, single, 1); !done) return done.error();
    row.before = single & 1;
    single = 1;
    if (auto done = read({start.i, start.j, start.k + kBrickSamples}, single, 1); !done) return done.error();
    row.after = single & 1;
    return row;
  }

 private:
  // Clears the bits of missing samples among `count` nodes from `start` on, which lie in one brick.
  Result<void> read(GridIndex start, std::uint64_t& bits, int count) {
    if (start.k < 0 || start.k >= volume_.shape().samples) return {};
    const std::size_t number = layout_.number(brick_of(start));
    if (!volume_.summary(number).has_missing) return {};
    const auto brick = held_brick(number, layout_.place(number).i);
    if (!brick) return brick.error();
    const int a = start.i - brick->first.i, b = start.j - brick->first.j, c = start.k - brick->first.k;
    const std::size_t offset = static_cast<std::size_t>((a * brick->extent.crosslines + b)) * brick->extent.samples + c;
    const int length = std::min(count, brick->extent.samples - c);
    for (int n = 0; n < length; ++n) {
      if (std::isnan(brick->samples[offset + n])) bits &= ~(std::uint64_t{1} << n);
    }
    return {};
  }

  // Rows come with rising i: the bricks of the present i are held, at most nine, since a filled volume puts a brick
  // together each time it is asked.
  Result<BrickView> held_brick(std::size_t number, std::int32_t place_i) {
    if (place_i != held_i_) held_.clear();
    held_i_ = place_i;
    for (const auto& [known, view] : held_) {
      if (known == number) return view;
    }
    auto brick = volume_.brick(number);
    if (brick) held_.emplace_back(number, *brick);
    return brick;
  }

  // A brick that holds the node: the one of which it is not the shared last layer, where there is a choice.
  GridIndex brick_of(GridIndex node) const {
    GridIndex brick;
    for (int axis = 0; axis < 3; ++axis) brick[axis] = std::min(node[axis] / kBrickCells, layout_.grid()[axis] - 1);
    return brick;
  }

  const BrickedVolume& volume_;
  BrickLayout layout_;
  std::int32_t held_i_ = -1;
  std::vector<std::pair<std::size_t, BrickView>> held_;
};

/// Bits first .. last of a word, where both may lie outside it.
std::uint64_t bit_range(int first, int last) {
  first = std::max(first, 0);
  last = std::min(last, 63);
  if (first > last) return 0;
  const std::uint64_t up_to_last = last == 63 ? ~std::uint64_t{0} : (std::uint64_t{1} << (last + 1)) - 1;
  return up_to_last & ~((std::uint64_t{1} << first) - 1);
}

}  // namespace

bool misses_nearby(const BrickedVolume& volume, GridIndex brick) {
  const BrickLayout layout(volume.shape());
  const GridShape grid = layout.grid();
  for (int i = std::max(brick.i - 1, 0); i <= std::min(brick.i + 1, grid.inlines - 1); ++i) {
    for (int j = std::max(brick.j - 1, 0); j <= std::min(brick.j + 1, grid.crosslines - 1); ++j) {
      for (int k = std::max(brick.k - 1, 0); k <= std::min(brick.k + 1, grid.samples - 1); ++k) {
        if (volume.summary(layout.number({i, j, k})).has_missing) return true;
      }
    }
  }
  return false;
}

Result<void> CellPresence::load(const BrickedVolume& volume, GridIndex brick, const GridBox& region) {
  const GridIndex first{brick.i * kBrickCells, brick.j * kBrickCells, brick.k * kBrickCells};
  fill_region(first, region);
  complete_ = true;
  for (int axis = 0; axis < 3; ++axis) {
    complete_ = complete_ && region.first[axis] < first[axis] && region.last[axis] > first[axis] + kBrickCells;
  }
  if (!misses_nearby(volume, brick)) return {};
  complete_ = false;
  return remove_missing(volume, first);
}

void CellPresence::fill_region(GridIndex first, const GridBox& region) {
  const auto bits = bit_range(region.first.k - first.k, region.last.k - 1 - first.k);
  const bool below = region.first.k < first.k && region.last.k >= first.k;
  row_.assign(static_cast<std::size_t>(kCells) * kCells, 0);
  below_.assign(row_.size(), 0);
  const auto in_region = [&](int axis, int cell) {
    const int global = first[axis] + cell;
    return global >= region.first[axis] && global < region.last[axis];
  };
  for (int a = -1; a < kBrickSamples; ++a) {
    for (int b = -1; b < kBrickSamples; ++b) {
      if (!in_region(0, a) || !in_region(1, b)) continue;
      row_[row_at(a, b)] = bits;
      below_[row_at(a, b)] = below;
    }
  }
}

Result<void> CellPresence::remove_missing(const BrickedVolume& volume, GridIndex first) {
  NodeReader reader(volume);
  std::vector<NodeRow> nodes(static_cast<std::size_t>(kNodes) * kNodes);
  for (int a = 0; a < kNodes; ++a) {
    for (int b = 0; b < kNodes; ++b) {
      auto row = reader.row({first.i + a - 1, first.j + b - 1, first.k});
      if (!row) return std::move(row).error();
      nodes[static_cast<std::size_t>(a * kNodes + b)] = *row;
    }
  }
  for (int a = 0; a < kCells; ++a) {
    for (int b = 0; b < kCells; ++b) {
      NodeRow all;
      for (int corner = 0; corner < 4; ++corner) {
        const NodeRow& row = nodes[static_cast<std::size_t>((a + corner / 2) * kNodes + b + corner % 2)];
        all.nodes &= row.nodes;
        all.before = all.before && row.before;
        all.after = all.after && row.after;
      }
      const std::size_t at = row_at(a - 1, b - 1);
      const std::uint64_t next = all.nodes >> 1 | std::uint64_t{all.after} << 63;
      row_[at] &= all.nodes & next;
      below_[at] = below_[at] && all.before && (all.nodes & 1);
    }
  }
  return {};
}

unsigned CellPresence::around_edge(int axis, int a, int b, int c) const {
  unsigned cells = 0;
  for (int n = 0; n < 4; ++n) {
    const int u = n / 2 - 1, v = n % 2 - 1;
    const bool present = axis == 0   ? is_present(a, b + u, c + v)
                         : axis == 1 ? is_present(a + u, b, c + v)
                                     : is_present(a + u, b + v, c);
    cells |= unsigned{present} << n;
  }
  return cells;
}

unsigned CellPresence::around_node(int a, int b, int c) const {
  unsigned cells = 0;
  for (int n = 0; n < 8; ++n) {
    cells |= unsigned{is_present(a + n / 4 - 1, b + n / 2 % 2 - 1, c + n % 2 - 1)} << n;
  }
  return cells;
}

std::uint64_t CellPresence::edges_of_cells(int axis, int a, int b) const {
  if (axis == 2) return row(a - 1, b - 1) | row(a - 1, b) | row(a, b - 1) | row(a, b);
  const int i = axis == 1 ? a - 1 : a, j = axis == 0 ? b - 1 : b;
  const std::uint64_t cells = row(i, j) | row(a, b);
  return cells | cells << 1 | before_row(i, j) | before_row(a, b);
}

std::uint64_t CellPresence::nodes_of_cells(int a, int b) const {
  return edges_of_cells(0, a - 1, b) | edges_of_cells(0, a, b);
}

std::uint64_t CellPresence::surrounded_nodes(int a, int b) const {
  const std::uint64_t cells = row(a - 1, b - 1) & row(a - 1, b) & row(a, b - 1) & row(a, b);
  const std::uint64_t before =
      before_row(a - 1, b - 1) & before_row(a - 1, b) & before_row(a, b - 1) & before_row(a, b);
  return cells & (cells << 1 | before);
}

}  // namespace geosis
