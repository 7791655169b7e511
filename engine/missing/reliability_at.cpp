#include "engine/missing/reliability_at.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "engine/base/parallel.h"
#include "engine/volume/sample_at.h"

namespace geosis {
namespace {

constexpr std::uint8_t kMeasured = 255;
constexpr float kMostOfFilled = 254;

/// The brick's reliabilities in place of its samples.
Result<BrickView> reliabilities_of(const FilledVolume& volume, std::size_t brick) {
  const auto samples = volume.brick(brick);
  if (!samples) return samples.error();
  const auto count = static_cast<std::size_t>(samples->extent.count());
  const auto values = std::make_shared<std::vector<float>>(count);
  for (std::size_t n = 0; n < count; ++n) (*values)[n] = std::isnan(samples->samples[n]) ? 0.0f : float{kMeasured};
  for (const FilledSample& filled : volume.filled(brick)) (*values)[filled.place] = filled.reliability;
  return BrickView{values->data(), samples->first, samples->extent, values};
}

std::uint8_t as_byte(float reliability) {
  if (reliability == float{kMeasured}) return kMeasured;
  return static_cast<std::uint8_t>(std::floor(std::min(reliability, kMostOfFilled) + 0.5f));
}

}  // namespace

Result<std::vector<std::uint8_t>> reliability_at(const FilledVolume& volume, std::span<const Vec3f> positions,
                                                 int threads, const Progress& progress) {
  const BrickGroups groups = group_by_brick(BrickLayout(volume.shape()), positions);
  std::vector<std::uint8_t> reliability(positions.size(), kMeasured);
  std::vector<std::optional<Error>> errors(groups.bricks.size());
  parallel_for(groups.bricks.size(), threads, [&](std::size_t g) {
    const std::size_t brick = groups.bricks[g];
    if (volume.filled(brick).empty() && !volume.summary(brick).has_missing) return;
    if (progress.cancelled()) {
      errors[g] = Error{ErrorCode::cancelled, "reading reliabilities was cancelled"};
      return;
    }
    const auto values = reliabilities_of(volume, brick);
    if (!values) {
      errors[g] = values.error();
      return;
    }
    for (const std::uint32_t n : groups.of(g)) reliability[n] = as_byte(interpolate(*values, positions[n]));
  });
  for (auto& error : errors) {
    if (error) return *std::move(error);
  }
  return reliability;
}

}  // namespace geosis
