#pragma once

#include <filesystem>
#include <optional>

#include "engine/volume/formats/import.h"

namespace geosis {

/// import_volume for files that hold samples and nothing else. options.dims is required and must agree with the size.
Result<ImportedVolume> import_raw(const ByteSource& source, const ImportOptions& options,
                                  const std::optional<std::filesystem::path>& brick_file, Progress& progress);

}  // namespace geosis
