#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/volume/formats/coordinate_fit.h"
#include "engine/volume/formats/import.h"
#include "engine/volume/formats/segy_headers.h"
#include "engine/volume/formats/trace_grid.h"

namespace geosis {

/// The coordinate words to try, best first: those of the options alone when given. errors: invalid_argument.
Result<std::vector<CoordinateWords>> coordinates_to_try(const ImportOptions& options);

/// The description of a SEG-Y volume as far as headers give it: all but sample counts, range and digest.
VolumeDescription describe_segy(const SegyLayout& layout, const FoundGrid& found, const ImportOptions& options,
                                std::span<const CoordinateWords> coordinates);

}  // namespace geosis
