#include "engine/volume/trace_order_writer.h"

#include <algorithm>
#include <cstring>
#include <vector>

namespace geosis {

TraceOrderWriter::TraceOrderWriter(BrickWriter& writer)
    : writer_(writer),
      indexers_(static_cast<std::size_t>(writer.layout().grid().crosslines) *
                static_cast<std::size_t>(writer.layout().grid().samples)) {}

Result<void> TraceOrderWriter::put(std::int32_t column, std::int32_t i, std::int32_t j,
                                   std::span<const float> samples) {
  const BrickLayout& layout = writer_.layout();
  const auto trace = static_cast<std::size_t>(layout.shape().samples);
  const std::int64_t crosslines = this->crosslines(column);
  const std::int64_t begin = i * crosslines + (j - first_crossline(column));  // in traces of the column
  const std::int64_t end = begin + static_cast<std::int64_t>(samples.size() / trace);
  // A shared inline ends one layer before it begins the next.
  GridIndex place{bricks_with(i, layout.grid().inlines).first, column, 0};
  for (; place.i < layout.grid().inlines; ++place.i) {
    const std::int64_t first = layout.first_node(place).i * crosslines;
    const std::int64_t from = std::max(begin, first);
    const std::int64_t to = std::min(end, first + layout.extent(place).inlines * crosslines);
    if (from >= to) break;
    const auto part =
        samples.subspan(static_cast<std::size_t>(from - begin) * trace, static_cast<std::size_t>(to - from) * trace);
    if (auto done = put_in_layer(place, from - first, part); !done) return done;
  }
  return {};
}

Result<void> TraceOrderWriter::put_in_layer(GridIndex place, std::int64_t first_row, std::span<const float> samples) {
  const BrickLayout& layout = writer_.layout();
  const GridShape extent = layout.extent(place);
  for (; place.k < layout.grid().samples; ++place.k)
    if (auto done = put_in_brick(place, first_row, samples); !done) return done;
  const auto traces = static_cast<std::int64_t>(samples.size()) / layout.shape().samples;
  if (first_row + traces == std::int64_t{extent.inlines} * extent.crosslines) {
    place.k = 0;
    writer_.start_writing(layout.number(place), static_cast<std::size_t>(layout.grid().samples));
  }
  return {};
}

Result<void> TraceOrderWriter::put_in_brick(GridIndex place, std::int64_t first_row, std::span<const float> samples) {
  const BrickLayout& layout = writer_.layout();
  const std::size_t brick = layout.number(place);
  const auto trace = static_cast<std::size_t>(layout.shape().samples);
  const auto row = static_cast<std::size_t>(layout.extent(place).samples);
  std::vector<float> rows(samples.size() / trace * row);
  const float* from = samples.data() + layout.first_node(place).k;
  for (float* to = rows.data(); to != rows.data() + rows.size(); to += row, from += trace)
    std::memcpy(to, from, row * sizeof(float));

  auto& indexer = indexers_[static_cast<std::size_t>(place.j) * static_cast<std::size_t>(layout.grid().samples) +
                            static_cast<std::size_t>(place.k)];
  if (!indexer) indexer.emplace(writer_.indexer(brick));
  indexer->add_rows(rows);
  if (indexer->is_complete()) {
    writer_.set_summary(brick, indexer->summary());
    indexer.reset();
  }
  return writer_.write_rows(brick, first_row, rows);
}

}  // namespace geosis
