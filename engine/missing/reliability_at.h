#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/base/vec3.h"
#include "engine/missing/file/filled_volume.h"

namespace geosis {

/// How far the samples around each position can be trusted: their reliabilities, mixed trilinearly as the values are.
///
/// returns   255 where only measured samples count; at most 254 where a filled or missing one does (missing = 0).
/// errors    malformed_input: a damaged brick.  cancelled.
/// cost      reads the bricks with missing samples that hold a position; 8 bytes a position beside the result.
Result<std::vector<std::uint8_t>> reliability_at(const FilledVolume& volume, std::span<const Vec3f> positions,
                                                 int threads, const Progress& progress);

}  // namespace geosis
