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
#include "engine/volume/brick_index.h"
#include "engine/volume/bricks.h"
#include "engine/volume/new_file.h"
#include "engine/volume/write_behind.h"

namespace geosis {

/// Fills a brick file with samples in any order, then indexes it.
///
///     auto writer = BrickWriter::create(shape, path);
///     writer->put(i, j, 0, trace);                  // every node once, from any threads
///     auto volume = writer->finish(threads, progress);
///
/// put() goes through mapped pages, which is dear for new ones: whoever has whole bricks, or their rows in order, gives
/// those. Memory: none but mapped pages of the file. A writer that is destroyed without finish() leaves nothing behind.
class BrickWriter {
 public:
  /// Reserves the whole file. path: where it appears when it is finished, replacing what is there; std::nullopt = an
  /// unnamed temporary file. errors: invalid_argument, limit_exceeded (axes), no_space, unavailable.
  static Result<BrickWriter> create(GridShape shape, const std::optional<std::filesystem::path>& path);

  /// Samples k0, k0 + 1, ... of the trace at (i, j), finite or NaN. Calls for different nodes may run at once.
  void put(std::int32_t i, std::int32_t j, std::int32_t k0, std::span<const float> samples);

  /// All samples of a brick, and its index. Calls for different bricks may run at once. errors: unavailable, no_space.
  Result<void> write_brick(std::size_t brick, std::span<const float> samples);

  /// Rows of a brick along the sample axis, from number `first_row` on, without its index. errors: unavailable,
  /// no_space.
  Result<void> write_rows(std::size_t brick, std::int64_t first_row, std::span<const float> samples) const;
  /// Indexes the rows of a brick as they come, straight into the file.
  BrickIndexer indexer(std::size_t brick);
  /// What the brick's indexer found; finish() leaves the brick alone then.
  void set_summary(std::size_t brick, const StoredSummary& summary);

  const BrickLayout& layout() const { return plan_.layout; }
  /// Begins to bring bricks to the disk, so that finish() has less to wait for; bricks that follow each other and stay
  /// as they are.
  void start_writing(std::size_t first_brick, std::size_t bricks) const;

  /// Index and checksums of all bricks, then the file gets its name (durably), and the volume opens.
  /// errors: cancelled, unavailable.
  Result<std::unique_ptr<BrickedVolume>> finish(int threads, Progress& progress) &&;

 private:
  BrickWriter(const BrickFilePlan& plan, NewFile file)
      : plan_(plan),
        file_(std::move(file)),
        indexed_(plan.layout.brick_count()),
        write_behind_(std::make_unique<WriteBehind>(file_.file())) {}

  std::uint64_t offset_of(std::size_t brick) const;

  BrickFilePlan plan_;
  NewFile file_;
  std::vector<std::uint8_t> indexed_;  ///< bricks, 0 or 1
  std::unique_ptr<WriteBehind> write_behind_;
};

}  // namespace geosis
