#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "engine/volume/formats/import.h"

namespace geosis {

/// import_volume for SEG-Y files.
///
/// Geometry: x and y are fitted to the CDP coordinates (bytes 181/185, else 73/77, or as the options say), z is the
/// sample axis. Without usable coordinates, x and y are the inline and crossline numbers, and a warning says why.
Result<ImportedVolume> import_segy(const ByteSource& source, const ImportOptions& options,
                                   const std::optional<std::filesystem::path>& brick_file, Progress& progress,
                                   std::vector<GridCandidate>* candidates);

}  // namespace geosis
