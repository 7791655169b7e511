#pragma once

#include <cstdint>
#include <memory>

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/structure/layer_map.h"
#include "engine/volume/bricks.h"

namespace geosis {

/// A region of a volume laid out along a structural grid: node (i, j, u) is the sample that the layer passes there, its
/// value untouched. A volume like any other, in which layers are level.
struct RectifiedVolume {
  GridIndex first;                         ///< (inline, crossline, layer) of its node (0, 0, 0)
  std::unique_ptr<BrickedVolume> samples;  ///< in a temporary file
};

/// map      of the region wanted; at least two nodes an axis.
/// errors   those of BrickWriter; malformed_input: a damaged brick.  cancelled.
/// cost     one read of the region and one write of its layers. The same for any number of threads.
Result<RectifiedVolume> rectify(const BrickedVolume& samples, const LayerMap& map, int threads, Progress& progress);

/// Which of `count` nodes of a trace, from layer on (full numbering), are the first to pass their sample, as bits.
/// first_layer   where the trace begins: its node counts.
std::uint64_t first_passes(const LayerMap& map, std::int32_t i, std::int32_t j, std::int32_t layer, int count,
                           std::int32_t first_layer);

}  // namespace geosis
