#include "engine/volume/coarse_volume.h"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "engine/volume/brick_file.h"
#include "engine/volume/sample_box.h"

namespace geosis {
namespace {

constexpr GridShape kShape = {70, 9, 80};

float value_at(int i, int j, int k) {
  if (i == 6 && j == 5) return std::numeric_limits<float>::quiet_NaN();
  return static_cast<float>(10'000 * i + 100 * j + k);
}

std::unique_ptr<BrickedVolume> volume() {
  std::vector<float> samples;
  for (int i = 0; i < kShape.inlines; ++i)
    for (int j = 0; j < kShape.crosslines; ++j)
      for (int k = 0; k < kShape.samples; ++k) samples.push_back(value_at(i, j, k));
  return make_bricked_volume(kShape, samples);
}

void expect_every(const GridBox& region, GridIndex step, GridIndex cut, GridShape shape) {
  NoProgress progress;
  const auto coarse = thin_out(*volume(), region, step, 2, progress);
  ASSERT_TRUE(coarse) << coarse.error().message;
  EXPECT_EQ(coarse->step, cut);
  ASSERT_EQ(coarse->samples->shape(), shape);
  const auto all = read_box(*coarse->samples, whole(shape));
  ASSERT_TRUE(all);
  for (int a = 0; a < shape.inlines; ++a) {
    for (int b = 0; b < shape.crosslines; ++b) {
      for (int c = 0; c < shape.samples; ++c) {
        const float expected =
            value_at(region.first.i + a * cut.i, region.first.j + b * cut.j, region.first.k + c * cut.k);
        const float found = all->value[all->at(a, b, c)];
        ASSERT_TRUE(found == expected || (std::isnan(found) && std::isnan(expected))) << a << " " << b << " " << c;
      }
    }
  }
}

TEST(CoarseVolume, KeepsEveryFewNodes) {
  expect_every(whole(kShape), {1, 1, 1}, {1, 1, 1}, kShape);
  expect_every(whole(kShape), {3, 2, 1}, {3, 2, 1}, {24, 5, 80});
  expect_every({{6, 1, 3}, {69, 8, 78}}, {4, 4, 5}, {4, 4, 5}, {16, 2, 16});
}

TEST(CoarseVolume, KeepsTwoNodesOfEveryAxis) {
  expect_every(whole(kShape), {100, 100, 50}, {69, 8, 50}, {2, 2, 2});
}

}  // namespace
}  // namespace geosis
