#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/volume/brick_format.h"
#include "engine/volume/bricks.h"
#include "engine/volume/new_file.h"

namespace geosis {

/// Fills a brick file with samples in any order, then indexes it.
///
///     auto writer = BrickWriter::create(shape, path);
///     writer->put(i, j, 0, trace);                  // every node once, from any threads
///     writer->complete(brick);                      // if it is known that all its samples are there
///     auto volume = writer->finish(threads, progress);
///
/// Memory: none but mapped pages of the file. A writer that is destroyed without finish() leaves nothing behind.
class BrickWriter {
 public:
  /// Reserves the whole file. path: where it appears when it is finished, replacing what is there; std::nullopt = an
  /// unnamed temporary file. errors: invalid_argument, limit_exceeded (axes), no_space, unavailable.
  static Result<BrickWriter> create(GridShape shape, const std::optional<std::filesystem::path>& path);

  /// Samples k0, k0 + 1, ... of the trace at (i, j), finite or NaN. Calls for different nodes may run at once.
  void put(std::int32_t i, std::int32_t j, std::int32_t k0, std::span<const float> samples);

  /// The same into the bricks of one layer along the sample axis alone, number bk: a sample on a shared layer is then
  /// put twice, once for each.
  void put_in_layer(std::int32_t bk, std::int32_t i, std::int32_t j, std::int32_t k0, std::span<const float> samples);

  const BrickLayout& layout() const { return plan_.layout; }
  /// Index and checksum of one brick, whose samples are all there and stay. finish() does this for all others. Calls
  /// for different bricks may run at once.
  void complete(std::size_t brick);
  /// Begins to write bricks to the disk, so that finish() has less to wait for; bricks that follow each other.
  void start_writing(std::size_t first_brick, std::size_t bricks) const;

  /// Index and checksums of all bricks, then the file gets its name (durably), and the volume opens.
  /// errors: cancelled, unavailable.
  Result<std::unique_ptr<BrickedVolume>> finish(int threads, Progress& progress) &&;

 private:
  BrickWriter(const BrickFilePlan& plan, NewFile file)
      : plan_(plan), file_(std::move(file)), completed_(plan.layout.brick_count()) {}

  BrickFilePlan plan_;
  NewFile file_;
  std::vector<std::uint8_t> completed_;  ///< bricks, 0 or 1
};

}  // namespace geosis
