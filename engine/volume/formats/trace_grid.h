#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/volume/formats/byte_source.h"
#include "engine/volume/formats/import.h"
#include "engine/volume/formats/segy_headers.h"
#include "engine/volume/formats/trace_scan.h"

namespace geosis {

/// The numbers of one axis of a survey: first, first + step, ... ; step > 0.
struct GridNumbers {
  HeaderWord word;
  std::int64_t first = 0, step = 1;
  std::int32_t count = 0;

  std::int32_t index_in(const HeaderView& header) const {
    return static_cast<std::int32_t>((word.in(header)-first) / step);
  }
};

/// Which traces a survey has: a bit for each (inline, crossline) position. 1/8 byte a position.
class TraceMap {
 public:
  TraceMap() = default;
  explicit TraceMap(std::int64_t positions) : occupied_(static_cast<std::size_t>(positions)) {}

  void add(std::int64_t position);
  bool occupied(std::int64_t position) const { return occupied_[static_cast<std::size_t>(position)]; }
  bool shared(std::int64_t position) const { return !shared_.empty() && shared_[static_cast<std::size_t>(position)]; }
  std::int64_t positions() const { return static_cast<std::int64_t>(occupied_.size()); }
  std::int64_t live() const { return live_; }              ///< positions with a trace
  std::int64_t duplicates() const { return duplicates_; }  ///< traces beyond the first of their position

 private:
  std::vector<bool> occupied_, shared_;
  std::int64_t live_ = 0, duplicates_ = 0;
};

/// How the traces of a file make a grid.
struct TraceGrid {
  GridNumbers inlines, crosslines;
  TraceMap map;

  std::int64_t position_in(const HeaderView& header) const {
    return std::int64_t{inlines.index_in(header)} * crosslines.count + crosslines.index_in(header);
  }
};

struct FoundGrid {
  TraceGrid grid;
  TraceScan scan;
};

/// Finds the header words under which the traces make one grid, in two passes over the trace headers.
///
/// Without options.inline_byte and crossline_byte the usual pairs of words are tried. A pair is a grid when both
/// numbers vary, no two traces share a position, and there are enough traces for the positions. Pairs that put every
/// trace at the same place count as one; a pair that would leave half of the positions empty which another fills is no
/// rival.
///
/// candidates  when not null and no single grid is found: those that came near.
/// errors      unsupported: 2D line, prestack, shot gathers.  malformed_input: no pair, or several.
///             invalid_argument: options.  limit_exceeded: a grid too sparse or too long.  cancelled.
Result<FoundGrid> find_grid(const ByteSource& source, const SegyLayout& layout, const ImportOptions& options,
                            Progress& progress, std::vector<GridCandidate>* candidates);

}  // namespace geosis
