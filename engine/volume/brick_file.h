#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/volume/bricks.h"

namespace geosis {

/// A volume in memory from all its samples (inlines, crosslines, samples), sample fastest, NaN = missing. For tests and
/// small volumes; big ones come from import_volume. Infinite samples become missing.
std::unique_ptr<BrickedVolume> make_bricked_volume(GridShape shape, std::span<const float> samples);

/// Maps a brick file (docs/formats/brick-file.md) and checks its header, index and size; bricks are checked at first
/// touch. The file must not change afterwards.
///
/// errors   not_found, unavailable; malformed_input: not a brick file, damaged or cut short; unsupported: its version.
Result<std::unique_ptr<BrickedVolume>> open_brick_file(const std::filesystem::path& path);

}  // namespace geosis
