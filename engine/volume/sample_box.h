#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/base/result.h"
#include "engine/volume/bricks.h"
#include "engine/volume/grid.h"

namespace geosis {

/// A box of the volume's nodes as one dense array, for what needs neighbours in every direction.
///
/// value (inlines, crosslines, samples) of the box, sample fastest; NaN = missing.
struct SampleBox {
  GridIndex first;  ///< the volume's node at value[0]
  GridShape shape;
  std::vector<float> value;

  std::size_t at(std::int32_t a, std::int32_t b, std::int32_t c) const {
    return (static_cast<std::size_t>(a) * shape.crosslines + b) * shape.samples + c;
  }
};

/// The samples of a box of the volume, which must lie in it.
///
/// errors   malformed_input: a damaged brick.
/// cost     reads only the bricks that the box touches; memory: the result.
Result<SampleBox> read_box(const BrickedVolume& volume, const GridBox& box);

}  // namespace geosis
