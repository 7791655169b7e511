#pragma once

#include <cstdint>
#include <vector>

#include "engine/missing/bit_lines.h"
#include "engine/volume/grid.h"

namespace geosis {

/// Which traces lie inside the survey's outline, (inlines, crosslines), 1 = inside.
///
/// A trace is valid if it has a valid sample. It is inside if its inline and its crossline both have a valid trace at
/// or before it and one at or after it. So a valid trace is inside wherever it lies, with all of its samples; a dead
/// trace has valid ones on all four sides. Nothing outside is ever filled.
std::vector<std::uint8_t> traces_inside(GridShape shape, const BitLines& valid);

}  // namespace geosis
