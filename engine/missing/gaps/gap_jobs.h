#pragma once

#include <cstdint>
#include <vector>

#include "engine/missing/gaps/gaps.h"
#include "engine/volume/grid.h"

namespace geosis {

/// Gaps by their narrower lateral side in traces: those from `first` to `last` are wide.
struct WideGaps {
  std::int32_t first = 1, last = 0;  ///< none
  GridShape margin{2, 2, 2};         ///< layers around what is wanted in them
};

/// How gaps are cut into boxes.
struct GapLimits {
  GridShape margin{2, 2, 2};           ///< layers around what is wanted; two hold all stencils
  WideGaps wide = {};                  ///< never in one box with others
  std::int32_t small_gap = 32;         ///< nodes a side: smaller gaps are solved together,
  std::int32_t small_tile = 64;        ///< those that begin in one tile
  std::int64_t whole_box = 4'000'000;  ///< nodes of the box of a gap that is solved whole
  std::int32_t tile = 128;             ///< nodes a side of the tiles of bigger gaps, at most
  std::int32_t overlap = 12;           ///< nodes that a tile solves beyond its own
};

/// Jobs of one wave do not read what others of it write: many small boxes, then big gaps whole, then eight waves of
/// tiles, of which no two neighbours are in one.
inline constexpr int kSmallWave = 0, kWholeWave = 1, kFirstTileWave = 2, kWaves = 10;

/// One box to solve.
struct GapJob {
  int wave = 0;
  std::uint32_t group = 0;  ///< it solves the nodes of the gaps in this group
  GridBox core;             ///< those whose values it decides
  GridBox solved;           ///< those that it solves; the core is among them
  GridIndex tiles_first;    ///< the corner of the gap that was cut into tiles of this size
  GridShape tile_shape;     ///< no nodes: not cut
  bool wide = false;        ///< of wide gaps

  /// The wave in which a node of the group is decided.
  int wave_of(GridIndex node) const;
};

struct GapPlan {
  std::vector<std::uint32_t> group_of;  ///< gap -> group
  std::vector<GapJob> jobs;             ///< by rising wave
};

GapPlan plan_gap_jobs(const Gaps& gaps, const GapLimits& limits);

/// The box with `layers` more on each side, as far as the volume goes.
GridBox grown(GridBox box, GridShape layers, GridShape shape);
GridShape shape_of(const GridBox& box);

}  // namespace geosis
