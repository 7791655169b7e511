#include "engine/volume/trace_order_writer.h"

#include <algorithm>
#include <cstring>
#include <vector>

namespace geosis {
namespace {

constexpr std::size_t kRowsAtOnce = 64;  // 16 KB: indexed while the nearest cache holds them

}  // namespace

TraceOrderWriter::TraceOrderWriter(BrickWriter& writer)
    : writer_(writer),
      rows_(static_cast<std::size_t>(writer.layout().grid().crosslines)),
      indexers_(static_cast<std::size_t>(writer.layout().grid().crosslines) *
                static_cast<std::size_t>(writer.layout().grid().samples)) {}

Result<void> TraceOrderWriter::put(std::int32_t column, std::int32_t i, std::int32_t j,
                                   std::span<const float* const> traces) {
  const BrickLayout& layout = writer_.layout();
  const std::int64_t crosslines = this->crosslines(column);
  const std::int64_t begin = i * crosslines + (j - first_crossline(column));  // in traces of the column
  const std::int64_t end = begin + static_cast<std::int64_t>(traces.size());
  // A shared inline ends one layer before it begins the next.
  GridIndex place{bricks_with(i, layout.grid().inlines).first, column, 0};
  for (; place.i < layout.grid().inlines; ++place.i) {
    const std::int64_t first = layout.first_node(place).i * crosslines;
    const std::int64_t from = std::max(begin, first);
    const std::int64_t to = std::min(end, first + layout.extent(place).inlines * crosslines);
    if (from >= to) break;
    const auto part = traces.subspan(static_cast<std::size_t>(from - begin), static_cast<std::size_t>(to - from));
    if (auto done = put_in_layer(place, from - first, part); !done) return done;
  }
  return {};
}

Result<void> TraceOrderWriter::put_in_layer(GridIndex place, std::int64_t first_row,
                                            std::span<const float* const> traces) {
  const BrickLayout& layout = writer_.layout();
  const GridShape extent = layout.extent(place);
  for (; place.k < layout.grid().samples; ++place.k)
    if (auto done = put_in_brick(place, first_row, traces); !done) return done;
  if (first_row + static_cast<std::int64_t>(traces.size()) == std::int64_t{extent.inlines} * extent.crosslines) {
    place.k = 0;
    writer_.start_writing(layout.number(place), static_cast<std::size_t>(layout.grid().samples));
  }
  return {};
}

Result<void> TraceOrderWriter::put_in_brick(GridIndex place, std::int64_t first_row,
                                            std::span<const float* const> traces) {
  const BrickLayout& layout = writer_.layout();
  const std::size_t brick = layout.number(place);
  const auto row = static_cast<std::size_t>(layout.extent(place).samples);
  std::vector<float>& rows = rows_[static_cast<std::size_t>(place.j)];
  if (rows.size() < traces.size() * row) rows.resize(traces.size() * row);

  auto& indexer = indexers_[static_cast<std::size_t>(place.j) * static_cast<std::size_t>(layout.grid().samples) +
                            static_cast<std::size_t>(place.k)];
  if (!indexer) indexer.emplace(writer_.indexer(brick));
  for (std::size_t begin = 0; begin < traces.size(); begin += kRowsAtOnce) {
    const std::size_t count = std::min(kRowsAtOnce, traces.size() - begin);
    float* const to = rows.data() + begin * row;
    for (std::size_t r = 0; r < count; ++r)
      std::memcpy(to + r * row, traces[begin + r] + layout.first_node(place).k, row * sizeof(float));
    indexer->add_rows({to, count * row});
  }
  if (indexer->is_complete()) {
    writer_.set_summary(brick, indexer->summary());
    indexer.reset();
  }
  return writer_.write_rows(brick, first_row, std::span(rows).first(traces.size() * row));
}

}  // namespace geosis
