#pragma once

#include <cstdint>
#include <vector>

#include "engine/base/result.h"
#include "engine/volume/bricks.h"

namespace geosis {

/// Which cells in and just around a brick belong to the domain: in the region and without a missing corner.
///
/// Cells are numbered from the brick's first node, -1 .. 63 an axis, so that every edge and node of the brick sees all
/// cells around it.
class CellPresence {
 public:
  /// errors: malformed_input (a damaged neighbour).  cost: 40 us; about 1 ms where samples are missing.
  Result<void> load(const BrickedVolume& volume, GridIndex brick, const GridBox& region);

  /// No cell around any node of the brick is absent.
  bool is_complete() const { return complete_; }
  bool is_present(int a, int b, int c) const {
    const std::size_t at = row_at(a, b);
    return c < 0 ? below_[at] : (row_[at] >> c) & 1;
  }
  /// Cells 0..63 of a row along the sample axis as bits, and cell -1.
  std::uint64_t row(int a, int b) const { return row_[row_at(a, b)]; }
  std::uint64_t before_row(int a, int b) const { return below_[row_at(a, b)]; }

  /// Cells around the edge along `axis` that starts at node (a, b, c), as bits: 2 * (first other axis: 0 = before the
  /// edge, 1 = after) + (second other axis).
  unsigned around_edge(int axis, int a, int b, int c) const;
  /// Cells around a node as bits 4 di + 2 dj + dk, each 0 = before the node, 1 = after.
  unsigned around_node(int a, int b, int c) const;

  /// Edges along `axis` (nodes) of row (a, b), as bits, with a present cell around them.
  std::uint64_t edges_of_cells(int axis, int a, int b) const;
  std::uint64_t nodes_of_cells(int a, int b) const;
  /// Nodes of the row whose 8 cells are all present.
  std::uint64_t surrounded_nodes(int a, int b) const;

 private:
  static constexpr int kCells = kBrickSamples + 1;  // -1 .. 63
  static std::size_t row_at(int a, int b) {
    return static_cast<std::size_t>(a + 1) * kCells + static_cast<std::size_t>(b + 1);
  }

  void fill_region(GridIndex first, const GridBox& region);
  Result<void> remove_missing(const BrickedVolume& volume, GridIndex first);

  std::vector<std::uint64_t> row_;
  std::vector<std::uint8_t> below_;
  bool complete_ = false;
};

/// Whether a sample is missing in the brick or in one that touches it.
bool misses_nearby(const BrickedVolume& volume, GridIndex brick);

}  // namespace geosis
