#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/volume/brick_writer.h"
#include "engine/volume/formats/byte_source.h"
#include "engine/volume/formats/raw_layout.h"
#include "engine/volume/formats/sample_tally.h"

namespace geosis {

/// Moves a raw file whose inline index is fastest: slice after slice along the sample axis, each to be turned. The file
/// is read once, in order, by the calling thread, while the slices before are turned.
///
/// brick_file  a file of at most 128 slices, without a name, is made beside it.
/// returns     SHA-256 of the file, hexadecimal.
/// memory      a brick of 1 MiB a thread, and a byte for each trace.
/// errors      no_space, unavailable, cancelled, and those of reading.
Result<std::string> move_slices(const ByteSource& source, const RawLayout& layout,
                                const std::optional<std::filesystem::path>& brick_file, BrickWriter& writer,
                                SampleTally& tally, Progress& progress);

}  // namespace geosis
