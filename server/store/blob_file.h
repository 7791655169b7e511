#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <vector>

#include "engine/base/result.h"
#include "server/store/file_calls.h"

namespace geosis::server {

// A put blob as a file: its bytes and their trailer (docs/formats/blob-file.md).

/// Writes bytes and trailer into the empty file at `path`, down to the disk. errors: no_space, unavailable.
Result<void> write_blob_file(FileCalls& calls, const std::filesystem::path& path, std::span<const std::byte> bytes);

/// The bytes, their checksum verified.
///
/// errors   not_found: no file of that name.  malformed_input: damaged.  unavailable.
Result<std::vector<std::byte>> read_blob_file(FileCalls& calls, const std::filesystem::path& path);

/// Brings a file that others wrote down to the disk. errors: no_space, unavailable.
Result<void> flush_file(FileCalls& calls, const std::filesystem::path& path);

}  // namespace geosis::server
