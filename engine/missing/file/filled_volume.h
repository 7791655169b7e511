#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>

#include "engine/base/result.h"
#include "engine/volume/bricks.h"

namespace geosis {

/// One filled sample of a brick.
struct FilledSample {
  std::uint32_t place = 0;       ///< in the brick's samples, as BrickView numbers them
  float value = 0;               ///< finite
  std::uint8_t reliability = 0;  ///< 0 (a guess) .. 254; a measured sample has 255
};

/// A volume whose missing samples have been filled where the method could: measured samples are those of the volume
/// below it, bit for bit; what stays missing is NaN. Summaries and block ranges are those of the filled samples.
///
/// It keeps the volume below by reference. A brick with filled samples is put together at each call of brick().
class FilledVolume : public BrickedVolume {
 public:
  /// The brick's filled samples, by rising place. Samples on a layer that bricks share are in each of them.
  virtual std::span<const FilledSample> filled(std::size_t brick) const = 0;
  /// Filled nodes of the volume, each counted once.
  virtual std::int64_t filled_count() const = 0;
};

/// Maps a fill file (docs/formats/fill-file.md) over the volume that it was made from.
///
/// errors   not_found, unavailable; malformed_input: not a fill file, damaged, cut short, or of another volume.
Result<std::unique_ptr<FilledVolume>> open_fill_file(const BrickedVolume& volume, const std::filesystem::path& path);

}  // namespace geosis
