#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>

#include "engine/missing/brick_row.h"
#include "engine/missing/gaps/bit_lines.h"
#include "engine/volume/brick_layout.h"

namespace geosis {

/// Rows of a brick with their nodes' bits: visit(first place of the row, the row, bits along k), while it returns
/// true.
///
/// nodes  one line a trace, i * crosslines + j
template <class Visit>
void visit_rows(const BrickLayout& layout, std::size_t brick, const BitLines& nodes, const Visit& visit) {
  const GridIndex place = layout.place(brick), first = layout.first_node(place);
  const GridShape extent = layout.extent(place);
  std::uint32_t row_place = 0;
  for (std::int32_t i = first.i; i < first.i + extent.inlines; ++i) {
    for (std::int32_t j = first.j; j < first.j + extent.crosslines; ++j) {
      const std::size_t trace = static_cast<std::size_t>(i) * layout.shape().crosslines + j;
      if (!visit(row_place, BrickRow{i, j, place.k}, nodes.bits(trace, first.k, extent.samples))) return;
      row_place += static_cast<std::uint32_t>(extent.samples);
    }
  }
}

/// Marked nodes of a brick.
inline std::uint32_t count_nodes(const BrickLayout& layout, std::size_t brick, const BitLines& nodes) {
  std::uint32_t count = 0;
  visit_rows(layout, brick, nodes, [&](std::uint32_t, const BrickRow&, std::uint64_t bits) {
    count += static_cast<std::uint32_t>(std::popcount(bits));
    return true;
  });
  return count;
}

}  // namespace geosis
