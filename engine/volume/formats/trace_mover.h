#pragma once

#include <atomic>
#include <compare>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/volume/brick_writer.h"
#include "engine/volume/formats/coordinate_fit.h"
#include "engine/volume/formats/record_stream.h"
#include "engine/volume/formats/sample_codec.h"
#include "engine/volume/formats/sample_tally.h"
#include "engine/volume/formats/segy_headers.h"
#include "engine/volume/formats/trace_grid.h"

namespace geosis {

/// Moves the samples of a SEG-Y file to their places in a brick file, in one pass from end to end, and collects what
/// can be learned on the way. Positions without a trace become missing.
///
/// memory  a few batches of traces, and 16 bytes for each trace that shares its position with another.
class TraceMover {
 public:
  TraceMover(const ByteSource& source, const SegyLayout& layout, const TraceGrid& grid, const ImportOptions& options,
             std::vector<CoordinateWords>& coordinates, BrickWriter& writer);

  /// returns  SHA-256 of the file, hexadecimal. errors: cancelled, unavailable, and those of reading.
  Result<std::string> move_all(int threads, Progress& progress);

  const SampleTally& tally() const { return tally_; }
  std::vector<Warning> warnings() const;

 private:
  struct SharedTrace {
    std::int64_t position = 0;
    std::uint64_t trace = 0;
    auto operator<=>(const SharedTrace&) const = default;
  };

  HeaderView header_of(std::span<const std::byte> trace) const { return trace_header_view(trace, layout_); }
  std::int64_t position_of(const HeaderView& header) const;
  void read_headers(const RecordBatch& batch);
  void move_batch(const RecordBatch& batch);
  void decode(std::span<const std::byte> trace, std::span<float> samples);
  void put(std::int64_t position, std::span<const float> samples);
  Result<void> move_shared(Progress& progress);
  Result<void> move_group(std::span<const SharedTrace> group);
  bool fill_absent(Progress& progress);

  const ByteSource& source_;
  const SegyLayout& layout_;
  const TraceGrid& grid_;
  const ImportOptions& options_;
  const NullValue null_;
  std::vector<CoordinateWords>& coordinates_;
  BrickWriter& writer_;
  SampleTally tally_;
  std::vector<SharedTrace> shared_;
  std::atomic<std::int64_t> dead_ = 0;
  bool changed_ = false;
};

}  // namespace geosis
