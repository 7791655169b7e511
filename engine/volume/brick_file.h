#pragma once

#include <memory>
#include <span>

#include "engine/base/result.h"
#include "engine/volume/bricks.h"

namespace geosis {

/// A volume in memory from all its samples (inlines, crosslines, samples), sample fastest, NaN = missing. For tests and
/// small volumes; big ones come from import_volume.
std::unique_ptr<BrickedVolume> make_bricked_volume(GridShape shape, std::span<const float> samples);

}  // namespace geosis
