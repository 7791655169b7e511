#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "engine/base/result.h"
#include "engine/volume/brick_layout.h"

namespace geosis {

// The bytes of a brick file, as docs/formats/brick-file.md describes them. All numbers are little-endian.

inline constexpr std::uint32_t kBrickFileVersion = 1;

/// One entry of the brick summary section.
struct StoredSummary {
  ValueRange range;
  std::uint32_t flags = 0;
  std::uint32_t reserved = 0;
  std::uint64_t checksum = 0;  ///< XXH3-64 of the brick's samples
};
static_assert(sizeof(StoredSummary) == 24);

inline constexpr std::uint32_t kHasMissing = 1;
inline constexpr std::uint32_t kAllMissing = 2;
inline constexpr std::size_t kBlockRangeBytes = kBlocksPerBrick * sizeof(ValueRange);

/// Where the parts of a brick file lie, in bytes from its start.
struct BrickFilePlan {
  BrickLayout layout;
  std::uint64_t summaries_at = 0, block_ranges_at = 0, samples_at = 0, file_bytes = 0;
};

/// The parts of a new file for volumes of this shape, which has passed check_axes.
BrickFilePlan plan_brick_file(GridShape shape);

/// Writes header and section table; the index sections must be in place, for their checksums.
void write_brick_header(const BrickFilePlan& plan, std::span<std::byte> file);

/// Checks header, section table and index of a whole file, whose bytes may be anything.
///
/// errors  malformed_input: not a brick file, cut short, damaged.  unsupported: another version.
Result<BrickFilePlan> read_brick_header(std::span<const std::byte> file);

}  // namespace geosis
