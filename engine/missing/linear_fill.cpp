#include "engine/missing/linear_fill.h"

#include <bit>
#include <cassert>
#include <cstdint>
#include <span>

#include "engine/missing/brick_nodes.h"

namespace geosis {

void fill_brick(const AxisBarycentre& barycentre, const BitLines& nodes, const BrickLayout& layout, std::size_t brick,
                FillWriter& writer, const Progress& progress) {
  const std::span<FilledSample> records = writer.records(brick);
  std::size_t next = 0, asked = 0;
  visit_rows(layout, brick, nodes, [&](std::uint32_t place, GridIndex node, std::uint64_t bits) {
    for (; bits != 0; bits &= bits - 1) {
      const int k = std::countr_zero(bits);
      const Estimate estimate = barycentre.at({node.i, node.j, node.k + k});
      assert(estimate.distance >= 0);
      FilledSample& record = records[next++];
      record.place = place + static_cast<std::uint32_t>(k);
      record.value = static_cast<float>(estimate.value);
      record.reliability = reliability_of(estimate.distance);
    }
    // A whole brick takes tens of milliseconds, one of its layers less than one.
    if (next < asked + 4096) return true;
    asked = next;
    return !progress.cancelled();
  });
}

}  // namespace geosis
