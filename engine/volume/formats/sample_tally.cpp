#include "engine/volume/formats/sample_tally.h"

#include <string>

namespace geosis {

void SampleTally::add_trace(std::int64_t samples, std::int64_t missing) {
  if (missing == 0) return;
  missing_ += missing;
  missing_traces_ += missing == samples;
}

void SampleTally::describe(const BrickedVolume& volume, VolumeDescription& description) const {
  description.missing_samples = missing_;
  description.missing_traces = missing_traces_;
  description.value_range = value_range(volume);
  if (missing_ == volume.shape().count())
    description.warnings.push_back({"no_valid_samples", "every sample is missing"});
  if (infinite_ > 0)
    description.warnings.push_back(
        {"infinite_samples", std::to_string(infinite_) + " samples are infinite or beyond float32: taken as missing"});
}

}  // namespace geosis
