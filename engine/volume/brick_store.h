#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "engine/base/progress.h"
#include "engine/volume/brick_format.h"

namespace geosis {

/// Writes samples k0, k0 + 1, ... of the trace at (i, j) into every brick that holds them: up to 4 columns of bricks,
/// and a node on a shared layer into both bricks of its column.
void store_samples(std::span<std::byte> file, const BrickFilePlan& plan, std::int32_t i, std::int32_t j,
                   std::int32_t k0, std::span<const float> samples);

/// Computes summary and block ranges of one brick, whose samples are all there.
void index_stored_brick(std::span<std::byte> file, const BrickFilePlan& plan, std::size_t brick);

/// Does that for all bricks but those that are `indexed` (empty: none), and writes the header. False when cancelled.
bool index_file(std::span<std::byte> file, const BrickFilePlan& plan, std::span<const std::uint8_t> indexed,
                int threads, Progress& progress);

}  // namespace geosis
