#pragma once

#include <cstdint>
#include <vector>

#include "engine/base/result.h"
#include "engine/volume/bricks.h"

namespace geosis {

/// The axis along which a slice has only one node.
enum class SliceAxis { inline_, crossline, sample };

/// One plane of a volume, laid out as it is drawn: row 0 at the top, time or depth downwards on a section.
///
///     axis        rows      columns
///     inline_     samples   crosslines   (vertical section along an inline)
///     crossline   samples   inlines      (vertical section along a crossline)
///     sample      inlines   crosslines   (time or depth slice)
struct Slice {
  std::int32_t rows = 0, columns = 0;
  std::vector<float> samples;  ///< (rows, columns), column fastest; NaN = missing
};

/// Largest slice: 256 MiB of samples.
inline constexpr std::int64_t kMaxSliceSamples = std::int64_t{1} << 26;

/// The plane of nodes with this index (0-based grid index, not an inline number) on the axis.
///
/// errors  invalid_argument: index outside the axis.  limit_exceeded: more than kMaxSliceSamples.
///         malformed_input: a damaged brick.
/// cost    reads only the bricks that the plane crosses; memory: the result.
Result<Slice> read_slice(const BrickedVolume& volume, SliceAxis axis, std::int32_t index);

}  // namespace geosis
