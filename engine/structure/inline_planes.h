#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "engine/base/result.h"
#include "engine/volume/bricks.h"
#include "engine/volume/sample_box.h"

namespace geosis {

/// Planes [first, end) of a volume, dense.
inline Result<SampleBox> read_planes(const BrickedVolume& volume, std::int32_t first, std::int32_t end) {
  const GridShape shape = volume.shape();
  return read_box(volume, {{first, 0, 0}, {end - 1, shape.crosslines - 1, shape.samples - 1}});
}

}  // namespace geosis
