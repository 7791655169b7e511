#pragma once

#include <atomic>
#include <cstdint>
#include <span>

#include "engine/volume/bricks.h"
#include "engine/volume/formats/import.h"
#include "engine/volume/formats/sample_codec.h"

namespace geosis {

/// What an import learns about its samples. Whole numbers added from any thread: the order does not matter.
class SampleTally {
 public:
  /// One position of the survey, with all its samples.
  void add_trace(std::int64_t samples, std::int64_t missing);
  void add_infinite(std::int64_t count) { infinite_ += count; }
  void add_missing(std::int64_t count) { missing_ += count; }

  /// Fills counts, value range and the warning about infinite samples.
  void describe(const BrickedVolume& volume, VolumeDescription& description) const;

 private:
  std::atomic<std::int64_t> missing_ = 0, infinite_ = 0, missing_traces_ = 0;
};

}  // namespace geosis
