#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>

#include "engine/base/result.h"
#include "engine/missing/file/fill_format.h"
#include "engine/missing/file/filled_volume.h"
#include "engine/volume/new_file.h"

namespace geosis {

/// Fills a fill file: records of each brick, then its index, then the file gets its name.
///
///     auto writer = FillWriter::create(volume, counts, path);
///     for (each record of writer->records(brick)) ...     // different bricks from any threads
///     writer->index(brick, has_missing);                    // every brick, when its records are final
///     auto filled = std::move(*writer).finish(filled_nodes);
///
/// A writer that is destroyed without finish() leaves nothing behind.
class FillWriter {
 public:
  /// counts  filled samples of each brick.  errors: no_space, unavailable.
  static Result<FillWriter> create(const BrickedVolume& volume, std::span<const std::uint32_t> counts,
                                   const std::optional<std::filesystem::path>& path);

  /// The brick's records, zeros at first. Padding must stay zero: assign the fields, not the records.
  std::span<FilledSample> records(std::size_t brick);
  /// The record of a node, nullptr = not filled. Places must have been written.
  FilledSample* find(GridIndex node);

  /// Summary, block ranges and checksum of a brick; has_missing = some of its samples stay missing.
  void index(std::size_t brick, bool has_missing);
  /// errors: unavailable.
  Result<std::unique_ptr<FilledVolume>> finish(std::uint64_t filled_nodes) &&;

 private:
  FillWriter(const BrickedVolume& volume, const FillFilePlan& plan, NewFile file)
      : volume_(volume), plan_(plan), file_(std::move(file)) {}
  StoredFill* summaries();

  const BrickedVolume& volume_;
  FillFilePlan plan_;
  NewFile file_;
};

}  // namespace geosis
