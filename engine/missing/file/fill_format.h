#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "engine/base/result.h"
#include "engine/missing/file/filled_volume.h"
#include "engine/volume/brick_layout.h"

namespace geosis {

// The bytes of a fill file, as docs/formats/fill-file.md describes them. All numbers are little-endian.

inline constexpr std::uint32_t kFillFileVersion = 1;

/// One entry of the brick summary section.
struct StoredFill {
  ValueRange range;            ///< of the brick's samples, measured and filled
  std::uint32_t flags = 0;     ///< kFillHasMissing, kFillAllMissing
  std::uint32_t count = 0;     ///< its records
  std::uint64_t first = 0;     ///< records of all bricks before it
  std::uint64_t checksum = 0;  ///< XXH3-64 of its records
};
static_assert(sizeof(StoredFill) == 32);
static_assert(sizeof(FilledSample) == 12 && offsetof(FilledSample, value) == 4 &&
              offsetof(FilledSample, reliability) == 8);

inline constexpr std::uint32_t kFillHasMissing = 1;
inline constexpr std::uint32_t kFillAllMissing = 2;
inline constexpr std::size_t kFillBlockBytes = kBlocksPerBrick * sizeof(ValueRange);

/// Where the parts of a fill file lie, in bytes from its start.
struct FillFilePlan {
  BrickLayout layout;
  std::uint64_t records = 0;       ///< of all bricks
  std::uint64_t filled_nodes = 0;  ///< each counted once
  std::uint64_t summaries_at = 0, block_ranges_at = 0, records_at = 0, file_bytes = 0;
};

/// The parts of a file for volumes of this shape, which has passed check_axes, with so many records.
FillFilePlan plan_fill_file(GridShape shape, std::uint64_t records);

/// Names the volume that a fill belongs to: XXH3-64 of its shape and its index.
std::uint64_t index_checksum(const BrickedVolume& volume);

/// Writes the header; summaries and block ranges must be in place, for their checksum.
void write_fill_header(const FillFilePlan& plan, std::uint64_t volume_checksum, std::span<std::byte> file);

/// Checks a whole file, whose bytes may be anything: header, index and every record.
///
/// errors  malformed_input: not a fill file, of another volume, cut short, damaged.  unsupported: another version.
/// cost    one read of the file
Result<FillFilePlan> read_fill_file(const BrickedVolume& volume, std::span<const std::byte> file);

}  // namespace geosis
