#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/missing/file/filled_volume.h"
#include "engine/missing/fill_options.h"
#include "engine/volume/bricks.h"

namespace geosis {

/// Fills the missing samples of a volume, as the options say, into a fill file.
///
/// path     where the file appears when it is finished (durably); std::nullopt = an unnamed temporary file.
/// returns  the filled volume, over `volume`, which it refers to. The same file for any number of threads.
/// errors   invalid_argument: method none, max_distance not above zero.  malformed_input: a damaged brick.  no_space,
///          unavailable: the file.  cancelled.
Result<std::unique_ptr<FilledVolume>> fill_missing(const BrickedVolume& volume, const FillOptions& options,
                                                   const std::optional<std::filesystem::path>& path, int threads,
                                                   Progress& progress);

}  // namespace geosis
