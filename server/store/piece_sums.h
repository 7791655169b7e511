#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "engine/base/result.h"

namespace geosis::server {

/// Checksums of a file that carries none of its own, piece by piece, so that a part of it can be read and judged.
inline constexpr std::size_t kSummedPiece = 1 << 16;

/// XXH3-64 of the bytes of one piece.
std::uint64_t sum_of_piece(std::span<const std::byte> bytes);

/// Of all pieces of a file, the last one shorter. errors: unavailable.
Result<std::vector<std::uint64_t>> sums_of_file(const std::filesystem::path& path);

}  // namespace geosis::server
