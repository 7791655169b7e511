#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "engine/base/result.h"
#include "engine/base/vec3.h"
#include "engine/volume/grid.h"

namespace geosis {

/// Cells that are turned inside out beside the others may make up this share of all.
inline constexpr double kMostFolded = 0.01;

/// What the nodes of a grid tell of it as a whole.
struct NodeReport {
  bool mirrored = false;          ///< right-handed index space becomes left-handed
  std::int64_t folded_cells = 0;  ///< with a corner that turns the other way than most corners of the grid do
  double folded_share = 0;        ///< of all cells
};

/// Looks at every cell of a grid. Flat ones are not folded.
///
/// nodes    shape.count() positions, sample fastest, finite; at least two an axis.
/// errors   malformed_input: more folded cells than kMostFolded; the message names one.
/// cost     O(cells); the same for any number of threads.
Result<NodeReport> look_at_cells(GridShape shape, std::span<const Vec3f> nodes, int threads);

/// "node [1,2,3]" of the node of that number.
std::string name_of_node(GridShape shape, std::size_t number);

/// The error of positions that make no grid.
Error bad_positions(const std::string& what);

}  // namespace geosis
