#include "engine/codec/gltf_matrices.h"

#include <cmath>
#include <random>
#include <string>

#include <gtest/gtest.h>

namespace geosis {
namespace {

double dot_of_columns(const Matrix3& m, int p, int q) {
  return m[p] * m[q] + m[3 + p] * m[3 + q] + m[6 + p] * m[6 + q];
}

TEST(SplitForGltf, MapsWithoutShearStayAsTheyAre) {
  for (const Matrix3& linear : {Matrix3{25, 0, 0, 0, 12.5, 0, 0, 0, 4}, Matrix3{0, 12.5, 0, -25, 0, 0, 0, 0, -4},
                                Matrix3{6, -8, 0, 0, 0, -2, 8, 6, 0}}) {
    const GltfMatrices split = split_for_gltf(linear);
    EXPECT_EQ(split.outer, linear);
    EXPECT_EQ(split.inner, (Matrix3{1, 0, 0, 0, 1, 0, 0, 0, 1}));
  }
}

TEST(SplitForGltf, AnyMapIsTheProductOfOrthogonalColumnsAndARotation) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> entry(-30, 30);
  for (int trial = 0; trial < 1000; ++trial) {
    Matrix3 linear;
    for (double& number : linear) number = entry(random);
    const auto [outer, inner] = split_for_gltf(linear);
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) {
        double product = 0;
        for (int k = 0; k < 3; ++k) product += outer[3 * row + k] * inner[3 * k + column];
        EXPECT_NEAR(product, linear[3 * row + column], 1e-11);
      }
    }
    for (int p = 0; p < 3; ++p) {
      EXPECT_NEAR(dot_of_columns(inner, p, p), 1, 1e-12);
      for (int q = 0; q < p; ++q) {
        EXPECT_NEAR(dot_of_columns(inner, p, q), 0, 1e-12);
        EXPECT_NEAR(dot_of_columns(outer, p, q), 0, 1e-8);
      }
    }
  }
}

TEST(SplitForGltf, FlatMapsComeBackToo) {
  const GltfMatrices split = split_for_gltf({1, 2, 0, 2, 4, 0, 0, 0, 0});
  for (const double number : split.outer) EXPECT_TRUE(std::isfinite(number));
}

}  // namespace
}  // namespace geosis
