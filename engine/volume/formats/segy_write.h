#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/volume/formats/import.h"
#include "engine/volume/geometry.h"
#include "engine/volume/grid.h"

namespace geosis {

/// What the headers of a survey file say.
struct SegySurvey {
  GridShape shape;
  Axis inline_axis, crossline_axis;  ///< whole survey numbers; `byte` is ignored
  Axis sample_axis{0, 4, 0};         ///< ms: first = delay recording time, step = sample interval
  AffineGeometry geometry;           ///< x and y of map(i, j, 0) become the CDP coordinates, kept to the centimetre
  std::string text;                  ///< up to 40 lines of up to 80 ASCII characters, parted by '\n'
};

/// Fills the samples of the trace at (i, j); traces are asked for once each, inline by inline.
using TraceSamples = std::function<void(std::int32_t i, std::int32_t j, std::span<float> samples)>;
/// True when the survey has a trace at (i, j); an empty function means everywhere.
using TraceMask = std::function<bool(std::int32_t i, std::int32_t j)>;

/// Writes a survey as SEG-Y revision 1, big-endian, IEEE floats (format 5): inline at byte 189, crossline at 193, CDP X
/// and Y at 181 and 185 with the scalar at 71, text header in EBCDIC. A failed call leaves no file behind.
///
/// samples  called in file order from one thread; one trace in memory at a time.
/// errors   invalid_argument: something that the headers cannot hold (more than 65535 samples, an interval that is not
///          a whole number of microseconds below 65536, a delay that is not a whole number of milliseconds, survey
///          numbers that are not whole, coordinates beyond 32 bits, text too long). unavailable: the file cannot be
///          written. no_space. cancelled.
Result<void> write_segy(const std::filesystem::path& path, const SegySurvey& survey, const TraceSamples& samples,
                        const TraceMask& is_live, Progress& progress);

}  // namespace geosis
