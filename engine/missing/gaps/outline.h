#pragma once

#include <cstdint>
#include <vector>

#include "engine/missing/gaps/bit_lines.h"
#include "engine/volume/grid.h"

namespace geosis {

/// Which traces lie inside the survey's outline, (inlines, crosslines), 1 = inside. Nothing outside is ever filled.
///
/// A trace is valid if it has a valid sample. It is inside if its inline and its crossline both have a valid trace at
/// or before it and one at or after it. So a valid trace is inside wherever it lies, with all of its samples. A line
/// without any valid trace (an inline that was not shot) says nothing about the outline: there the other line decides
/// alone. Where two such lines cross, traces that are inside must lie on both sides on both lines.
std::vector<std::uint8_t> traces_inside(GridShape shape, const BitLines& valid);

}  // namespace geosis
