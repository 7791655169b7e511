#include "engine/volume/sample_at.h"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "engine/volume/brick_file.h"

namespace geosis {
namespace {

constexpr float kMissing = std::numeric_limits<float>::quiet_NaN();

/// A volume of several bricks along two axes whose samples are a trilinear polynomial of the node.
constexpr GridShape kShape{70, 3, 131};
float polynomial(double i, double j, double k) {
  return static_cast<float>(i + 2 * j - 4 * k + i * j * 0.5 + j * k * 0.25 - i * k * 0.125 + i * j * k / 64);
}

std::vector<float> polynomial_samples() {
  std::vector<float> samples;
  for (int i = 0; i < kShape.inlines; ++i) {
    for (int j = 0; j < kShape.crosslines; ++j) {
      for (int k = 0; k < kShape.samples; ++k) samples.push_back(polynomial(i, j, k));
    }
  }
  return samples;
}

std::vector<float> values_at(const std::vector<float>& samples, const std::vector<Vec3f>& positions, int threads = 1) {
  const auto volume = make_bricked_volume(kShape, samples);
  auto values = sample_at(*volume, positions, threads, NoProgress());
  EXPECT_TRUE(values);
  return values ? *std::move(values) : std::vector<float>{};
}

TEST(SampleAt, ReproducesTrilinearFunctionsInEveryBrick) {
  std::vector<Vec3f> positions;
  for (float i : {0.0f, 12.25f, 62.5f, 63.0f, 63.75f, 69.0f}) {
    for (float k : {0.0f, 62.75f, 63.0f, 64.5f, 126.0f, 130.0f}) positions.push_back({i, 1.5f, k});
  }
  const auto values = values_at(polynomial_samples(), positions, 2);
  ASSERT_EQ(values.size(), positions.size());
  for (std::size_t n = 0; n < values.size(); ++n) {
    const float expected = polynomial(positions[n].x, positions[n].y, positions[n].z);
    EXPECT_NEAR(values[n], expected, 1e-6 * std::abs(expected) + 1e-6) << n;
  }
}

TEST(SampleAt, ReadsNodesAsTheyAre) {
  EXPECT_EQ(values_at(polynomial_samples(), {{69, 2, 130}, {63, 0, 63}, {0, 1, 126}}),
            (std::vector<float>{polynomial(69, 2, 130), polynomial(63, 0, 63), polynomial(0, 1, 126)}));
}

TEST(SampleAt, IsMissingOnlyWhereAMissingSampleCounts) {
  auto samples = polynomial_samples();
  samples[static_cast<std::size_t>((5 * kShape.crosslines + 1) * kShape.samples + 7)] = kMissing;
  const auto values =
      values_at(samples, {{4.5f, 1, 7}, {4.5f, 1, 6}, {5, 0.5f, 7}, {5, 1, 7.25f}, {4, 1, 7}, {5, 2, 7}});
  EXPECT_TRUE(std::isnan(values[0]));
  EXPECT_FALSE(std::isnan(values[1]));
  EXPECT_TRUE(std::isnan(values[2]));
  EXPECT_TRUE(std::isnan(values[3]));
  EXPECT_FALSE(std::isnan(values[4]));
  EXPECT_FALSE(std::isnan(values[5]));
}

TEST(GroupByBrick, KeepsEachPositionOnceInItsOrder) {
  const std::vector<Vec3f> positions = {{65, 0, 100}, {0, 0, 0}, {64, 1, 99}, {1, 1, 1}, {0, 2, 130}};
  const BrickGroups groups = group_by_brick(BrickLayout(kShape), positions);
  std::vector<std::vector<std::uint32_t>> lists;
  for (std::size_t g = 0; g < groups.bricks.size(); ++g) {
    lists.emplace_back(groups.of(g).begin(), groups.of(g).end());
    for (const std::uint32_t n : lists.back()) {
      const GridIndex place = BrickLayout(kShape).place(groups.bricks[g]);
      EXPECT_EQ(place.i, positions[n].x < 63 ? 0 : 1);
      EXPECT_EQ(place.k, positions[n].z < 63 ? 0 : positions[n].z < 126 ? 1 : 2);
    }
  }
  EXPECT_EQ(lists, (std::vector<std::vector<std::uint32_t>>{{1, 3}, {4}, {0, 2}}));
}

}  // namespace
}  // namespace geosis
