#include "engine/missing/linear_fill.h"

#include <bit>
#include <cassert>
#include <cstdint>
#include <span>

#include "engine/missing/brick_nodes.h"

namespace geosis {
namespace {

constexpr std::size_t kNodesAtOnce = 4096;

}  // namespace

void fill_brick(const AxisBarycentre& barycentre, const BitLines& nodes, const BrickLayout& layout, std::size_t brick,
                FillWriter& writer, const Progress& progress) {
  const std::span<FilledSample> records = writer.records(brick);
  AxisBarycentre::Row estimates;
  std::size_t next = 0, asked = 0;
  visit_rows(layout, brick, nodes, [&](std::uint32_t place, const BrickRow& row, std::uint64_t bits) {
    if (bits == 0) return true;
    barycentre.estimate(row, bits, estimates);
    for (; bits != 0; bits &= bits - 1) {
      const auto k = static_cast<std::uint32_t>(std::countr_zero(bits));
      assert(estimates[k].distance >= 0);
      FilledSample& record = records[next++];
      record.place = place + k;
      record.value = static_cast<float>(estimates[k].value);
      record.reliability = reliability_of(estimates[k].distance);
    }
    // A whole brick may take tens of milliseconds, so many nodes less than one.
    if (next < asked + kNodesAtOnce) return true;
    asked = next;
    return !progress.cancelled();
  });
}

}  // namespace geosis
