#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "engine/base/progress.h"
#include "engine/missing/gaps/bit_lines.h"
#include "engine/volume/grid.h"

namespace geosis {

/// Missing nodes of one trace without a valid one between them; both ends belong to it.
struct NodeRun {
  std::int32_t first = 0, last = 0;
};

struct Gap {
  GridBox box;
  std::int64_t nodes = 0;
};

/// Nodes to fill, as gaps: two nodes are in one gap if a stencil of second differences can hold both, that is, up to
/// two steps apart on an axis, or neighbours across a diagonal of a plane. So gaps can be solved one by one.
///
/// Memory: 12 bytes a run, 32 a gap; at most 44 bytes a node.
struct Gaps {
  GridShape shape;
  std::vector<std::uint32_t> first_run;  ///< (traces + 1) into runs; trace i * crosslines + j
  std::vector<NodeRun> runs;             ///< trace after trace, by rising k
  std::vector<std::uint32_t> gap_of;     ///< run -> gap
  std::vector<Gap> gaps;                 ///< in the order of their first run

  std::span<const NodeRun> runs_of(std::size_t trace) const {
    return std::span(runs).subspan(first_run[trace], first_run[trace + 1] - first_run[trace]);
  }
};

/// nodes    one line a trace.  returns std::nullopt when cancelled.  cost: O(runs).
std::optional<Gaps> find_gaps(GridShape shape, const BitLines& nodes, const Progress& progress);

}  // namespace geosis
