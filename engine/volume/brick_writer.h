#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>

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

  /// Index and checksums of all bricks, then the file gets its name (durably), and the volume opens.
  /// errors: cancelled, unavailable.
  Result<std::unique_ptr<BrickedVolume>> finish(int threads, Progress& progress) &&;

 private:
  BrickWriter(const BrickFilePlan& plan, NewFile file) : plan_(plan), file_(std::move(file)) {}

  BrickFilePlan plan_;
  NewFile file_;
};

}  // namespace geosis
