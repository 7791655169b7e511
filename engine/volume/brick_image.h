#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>

#include "engine/volume/brick_format.h"
#include "engine/volume/bricks.h"

namespace geosis {

/// The bytes of a brick file, wherever they are held, as a volume.
class BrickImage final : public BrickedVolume {
 public:
  /// bytes: a whole brick file that read_brick_header has accepted as `plan`; owner keeps them alive.
  BrickImage(std::shared_ptr<const void> owner, std::span<const std::byte> bytes, const BrickFilePlan& plan);

  GridShape shape() const override { return plan_.layout.shape(); }
  GridShape brick_grid() const override { return plan_.layout.grid(); }
  std::size_t brick_count() const override { return plan_.layout.brick_count(); }
  BrickSummary summary(std::size_t brick) const override;
  std::span<const ValueRange, kBlocksPerBrick> block_ranges(std::size_t brick) const override;
  Result<BrickView> brick(std::size_t brick) const override;

 private:
  enum class State : std::uint8_t { unchecked, sound, damaged };

  const StoredSummary& stored_summary(std::size_t brick) const;
  bool is_sound(std::size_t brick, std::span<const float> samples) const;

  std::shared_ptr<const void> owner_;
  std::span<const std::byte> bytes_;
  BrickFilePlan plan_;
  // What the checksum of each brick said. Two threads may check the same brick at once: both find the same.
  std::unique_ptr<std::atomic<State>[]> states_;
};

}  // namespace geosis
