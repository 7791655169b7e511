#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace geosis::generator {

/// Where the level crosses the cell's surface, given the sign mask and which ambiguous faces join the corners above.
struct CellLoops {
  /// Closed polygons over crossed cell edges. Somebody outside the cell who walks along one has the corners below the
  /// level on the left; a patch with this boundary is counter-clockwise seen from below the level.
  std::vector<std::vector<int>> loops;
  std::array<int, 8> region{};    ///< corner -> smallest corner of its region (joined along edges or faces)
  std::vector<int> above, below;  ///< loop -> the region on either side
};

CellLoops trace_loops(std::uint8_t above, std::uint8_t joined_faces);

/// Crossed edges (a, b) that a face joins by a segment of some loop.
bool is_segment(const CellLoops& cell, int a, int b);

}  // namespace geosis::generator
