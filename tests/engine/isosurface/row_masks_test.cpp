#include "engine/isosurface/row_masks.h"

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <hwy/highway.h>

namespace geosis {
namespace {

std::vector<float> awkward_samples(std::size_t count) {
  std::mt19937 random(3);
  const float values[] = {0.0f,
                          -0.0f,
                          1.0f,
                          std::nextafter(1.0f, 2.0f),
                          -2.0f,
                          std::numeric_limits<float>::quiet_NaN(),
                          std::numeric_limits<float>::max(),
                          std::numeric_limits<float>::denorm_min(),
                          0.5f};
  std::vector<float> samples(count);
  for (float& f : samples) f = values[random() % std::size(values)];
  return samples;
}

TEST(ClassifyRows, GivesTheScalarLoopsBitsUnderEveryTarget) {
  const float infinity = std::numeric_limits<float>::infinity();
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    for (std::size_t length = 1; length <= 64; ++length) {
      const auto samples = awkward_samples(3 * length);
      for (const auto& [low, high] : {std::pair{0.0f, 1.0f}, {-infinity, 0.5f}, {1.0f, infinity}}) {
        RowMasks fast[3], plain[3];
        classify_rows(samples.data(), 3, length, low, high, fast);
        classify_rows_scalar(samples.data(), 3, length, low, high, plain);
        for (int row = 0; row < 3; ++row) {
          EXPECT_EQ(fast[row].valid, plain[row].valid) << hwy::TargetName(target) << " length " << length;
          EXPECT_EQ(fast[row].at_least, plain[row].at_least) << hwy::TargetName(target) << " length " << length;
          EXPECT_EQ(fast[row].greater, plain[row].greater) << hwy::TargetName(target) << " length " << length;
        }
      }
    }
  }
  hwy::SetSupportedTargetsForTest(0);
}

}  // namespace
}  // namespace geosis
