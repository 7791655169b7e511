#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "engine/base/result.h"
#include "engine/volume/brick_writer.h"

namespace geosis {

/// Fills a brick file with traces in storage order, inline after inline: the rows of each brick then come in order, so
/// that its index and checksum grow with it and nothing is read back. Bricks of one crossline column are one task:
/// columns are independent of each other.
///
///     TraceOrderWriter traces(writer);
///     parallel_for(traces.columns(), ...  traces.put(column, i, j, pointers));   // all traces of the column, in order
///
/// memory  0.6 KB for each brick of one layer, once its first rows are there; for each column what one brick gets at
///         once.
class TraceOrderWriter {
 public:
  /// writer must live as long.
  explicit TraceOrderWriter(BrickWriter& writer);

  std::int32_t columns() const { return writer_.layout().grid().crosslines; }
  /// Crosslines of a column: neighbours share one, whose traces both get.
  std::int32_t first_crossline(std::int32_t column) const { return column * kBrickCells; }
  std::int32_t crosslines(std::int32_t column) const { return writer_.layout().extent({0, column, 0}).crosslines; }

  /// Whole traces of the column, each where it lies, from inline i and crossline j on: the column's crosslines, then
  /// those of the next inline. Many at once are written in longer pieces. errors: unavailable, no_space.
  Result<void> put(std::int32_t column, std::int32_t i, std::int32_t j, std::span<const float* const> traces);

 private:
  Result<void> put_in_layer(GridIndex place, std::int64_t first_row, std::span<const float* const> traces);
  Result<void> put_in_brick(GridIndex place, std::int64_t first_row, std::span<const float* const> traces);

  BrickWriter& writer_;
  std::vector<std::vector<float>> rows_;               ///< of each column, on their way
  std::vector<std::optional<BrickIndexer>> indexers_;  ///< of the bricks of one layer that have begun
};

}  // namespace geosis
