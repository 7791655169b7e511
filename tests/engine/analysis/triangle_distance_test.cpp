#include "engine/analysis/triangle_distance.h"

#include <algorithm>
#include <random>
#include <string>

#include <gtest/gtest.h>

namespace geosis {
namespace {

const Vec3d kA = {0, 0, 0}, kB = {4, 0, 0}, kC = {0, 3, 0};

double to_triangle(Vec3d point) {
  return squared_distance_to_triangle(point, kA, kB, kC);
}

TEST(TriangleDistance, AboveTheInside) {
  EXPECT_DOUBLE_EQ(to_triangle({1, 1, 2}), 4);
  EXPECT_DOUBLE_EQ(to_triangle({1, 1, -2}), 4);
  EXPECT_DOUBLE_EQ(to_triangle({1, 1, 0}), 0);
}

TEST(TriangleDistance, BesideAnEdge) {
  EXPECT_DOUBLE_EQ(to_triangle({2, -3, 4}), 25);
  EXPECT_DOUBLE_EQ(to_triangle({2 + 3, 1.5 + 4, 0}), 25);  // square to the long edge, from its middle
}

TEST(TriangleDistance, BeyondACorner) {
  EXPECT_DOUBLE_EQ(to_triangle({-1, -2, 2}), 9);
  EXPECT_DOUBLE_EQ(to_triangle({7, 0, 4}), 25);
}

TEST(TriangleDistance, TrianglesThatAreSegmentsOrPoints) {
  EXPECT_DOUBLE_EQ(squared_distance_to_triangle({1, 2, 0}, {0, 0, 0}, {4, 0, 0}, {2, 0, 0}), 4);
  EXPECT_DOUBLE_EQ(squared_distance_to_triangle({6, 0, 0}, {0, 0, 0}, {4, 0, 0}, {0, 0, 0}), 4);
  EXPECT_DOUBLE_EQ(squared_distance_to_triangle({1, 2, 2}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}), 9);
}

/// The nearest of a fine set of points on the triangle is never nearer, and hardly further.
TEST(TriangleDistance, AgreesWithPointsOnTheTriangle) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(-2, 2);
  const auto point = [&] { return Vec3d{place(random), place(random), place(random)}; };
  for (int round = 0; round < 200; ++round) {
    const Vec3d p = point(), a = point(), b = point(), c = point();
    double nearest = 1e9;
    constexpr int kSteps = 60;
    for (int u = 0; u <= kSteps; ++u) {
      for (int v = 0; u + v <= kSteps; ++v) {
        const Vec3d on = a + (b - a) * (double(u) / kSteps) + (c - a) * (double(v) / kSteps);
        nearest = std::min(nearest, norm(p - on));
      }
    }
    const double exact = std::sqrt(squared_distance_to_triangle(p, a, b, c));
    EXPECT_LE(exact, nearest + 1e-12);
    EXPECT_GE(exact, nearest - 7.0 / kSteps);
  }
}

}  // namespace
}  // namespace geosis
