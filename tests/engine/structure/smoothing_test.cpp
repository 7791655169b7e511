#include "engine/structure/smoothing.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace geosis {
namespace {

TEST(SmoothingKernel, HasSumOneAndTheVarianceAskedFor) {
  for (const double sigma : {0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 7.3}) {
    const auto half = smoothing_kernel(sigma);
    double sum = half[0], variance = 0;
    for (std::size_t t = 1; t < half.size(); ++t) {
      sum += 2 * half[t];
      variance += 2 * half[t] * static_cast<double>(t * t);
    }
    EXPECT_NEAR(sum, 1, 1e-6) << sigma;
    EXPECT_NEAR(variance, sigma * sigma, 1e-5 * sigma * sigma) << sigma;
    EXPECT_LE(static_cast<double>(half.size()), 2 * std::sqrt(3.0) * sigma + 5) << sigma;
  }
}

TEST(SmoothingKernel, LooksLikeAGaussian) {
  const auto half = smoothing_kernel(4);
  for (std::size_t t = 0; t < half.size(); ++t) {
    const double gauss = std::exp(-static_cast<double>(t * t) / 32) / std::sqrt(2 * 3.14159265358979 * 16);
    EXPECT_NEAR(half[t], gauss, 0.004) << t;
  }
}

TEST(SmoothingKernel, OfNothingChangesNothing) {
  EXPECT_EQ(smoothing_kernel(0), std::vector<float>{1.0f});
}

TEST(Smooth, SpreadsAPulseAsTheProductOfTheKernels) {
  const GridShape shape = {21, 25, 41};
  std::vector<float> field(static_cast<std::size_t>(shape.count()), 0.0f);
  const auto at = [&](int i, int j, int k) { return (static_cast<std::size_t>(i) * 25 + j) * 41 + k; };
  field[at(10, 12, 20)] = 1;
  smooth(field, shape, {1, 1.5, 2}, 1);
  const auto x = smoothing_kernel(1), y = smoothing_kernel(1.5), z = smoothing_kernel(2);
  const auto weight = [](const std::vector<float>& half, int t) {
    const auto n = static_cast<std::size_t>(std::abs(t));
    return n < half.size() ? half[n] : 0.0f;
  };
  for (int i = 0; i < 21; ++i) {
    for (int j = 0; j < 25; ++j) {
      for (int k = 0; k < 41; ++k) {
        ASSERT_NEAR(field[at(i, j, k)], weight(x, i - 10) * weight(y, j - 12) * weight(z, k - 20), 1e-7);
      }
    }
  }
}

TEST(Smooth, IsTheSameForAnyNumberOfThreads) {
  const GridShape shape = {7, 9, 12};
  std::vector<float> field(static_cast<std::size_t>(shape.count()));
  for (std::size_t n = 0; n < field.size(); ++n) field[n] = static_cast<float>(n * n % 101) / 7;
  auto other = field;
  smooth(field, shape, {2, 2, 4}, 1);
  smooth(other, shape, {2, 2, 4}, 5);
  EXPECT_EQ(field, other);
}

TEST(Smooth, TakesTheFieldAsZeroOutside) {
  std::vector<float> field = {1, 1, 1};
  smooth(field, {1, 1, 3}, {3, 3, 0.5}, 1);
  EXPECT_GT(field[1], field[0]);
  EXPECT_FLOAT_EQ(field[0], field[2]);
}

}  // namespace
}  // namespace geosis
