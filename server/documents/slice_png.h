#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "engine/base/result.h"
#include "engine/volume/slice.h"

namespace geosis::server {

enum class Colormap {
  gray,     ///< black to white
  seismic,  ///< blue, white, red: amplitudes around zero
  viridis,  ///< dark violet to yellow, evenly rising lightness
};

/// "gray", "seismic", "viridis". errors: invalid_argument (another name).
Result<Colormap> parse_colormap(std::string_view name);

/// Largest image, in pixels.
inline constexpr std::int64_t kMaxPngPixels = std::int64_t{1} << 26;

/// The slice as a PNG image, one pixel a sample, 8-bit RGBA: `low` and below get the first colour, `high` and above the
/// last one, missing samples are transparent. With low == high, samples equal to both get the middle colour.
///
/// errors  invalid_argument: low > high, not finite, or a slice whose samples are not (rows, columns), rows and columns
///         at least 1.  limit_exceeded: more than kMaxPngPixels.  internal: libpng says why.
/// cost    memory: the result and one row.
Result<std::vector<std::byte>> slice_png(const Slice& slice, float low, float high, Colormap colormap);

}  // namespace geosis::server
