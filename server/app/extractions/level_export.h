#pragma once

#include <filesystem>
#include <string>

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "server/app/extractions/extraction.h"
#include "server/app/extractions/extractions.h"

namespace geosis::server {

/// "levels/0.ply": the key's last part.
std::string level_file_name(int level, LevelFormat format);

/// Writes level `level` of a finished extraction, whole, into a file: decoded from its parts, joined along the seams,
/// and encoded as one Draco file, or as GLB, or mapped to the requested space as PLY, OBJ or STL
/// (STL minus the manifest's origin).
///
/// returns   {"sha256", "bytes", "sums"} of the file, the last by piece (sum_of_piece).
/// errors    those of the part reader; malformed_input: damaged parts; unavailable: writing failed.
Result<Json> export_level(const std::filesystem::path& path, const Json& manifest, int level, LevelFormat format,
                          const PartReader& read_part, int threads, Progress& progress);

}  // namespace geosis::server
