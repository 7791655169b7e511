#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "engine/missing/file/fill_format.h"
#include "engine/missing/file/filled_volume.h"

namespace geosis {

/// The bytes of a fill file, wherever they are held, over the volume that it belongs to.
class FillImage final : public FilledVolume {
 public:
  /// bytes: a whole fill file that read_fill_file has accepted as `plan`; owner keeps them alive, not the volume.
  FillImage(const BrickedVolume& volume, std::shared_ptr<const void> owner, std::span<const std::byte> bytes,
            const FillFilePlan& plan);

  GridShape shape() const override { return volume_.shape(); }
  GridShape brick_grid() const override { return volume_.brick_grid(); }
  std::size_t brick_count() const override { return volume_.brick_count(); }
  BrickSummary summary(std::size_t brick) const override;
  std::span<const ValueRange, kBlocksPerBrick> block_ranges(std::size_t brick) const override;
  /// errors: malformed_input (damaged brick of the volume below, or a record of a measured sample).
  Result<BrickView> brick(std::size_t brick) const override;
  std::span<const FilledSample> filled(std::size_t brick) const override;
  std::int64_t filled_count() const override { return static_cast<std::int64_t>(plan_.filled_nodes); }

 private:
  const StoredFill& stored(std::size_t brick) const;

  const BrickedVolume& volume_;
  std::shared_ptr<const void> owner_;
  std::span<const std::byte> bytes_;
  FillFilePlan plan_;
};

}  // namespace geosis
