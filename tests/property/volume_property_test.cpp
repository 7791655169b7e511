#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tests/property/surface_laws.h"
#include "tests/support/phantoms.h"
#include "tests/support/supersampling.h"

// The volume that the surface encloses is the body's.

namespace geosis::test {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();

double enclosed(const ScalarField& field, IsoRange range, BodyMode mode = BodyMode::exact) {
  return census(extract_surface(field, range, mode)).volume;
}

TEST(EnclosedVolume, ConstantFieldInTheRangeGivesExactlyTheBox) {
  for (const GridShape shape : {GridShape{2, 2, 2}, {4, 5, 6}, {70, 3, 66}}) {
    const double box = (shape.inlines - 1.0) * (shape.crosslines - 1.0) * (shape.samples - 1.0);
    for (const BodyMode mode : {BodyMode::exact, BodyMode::sampled}) {
      EXPECT_EQ(enclosed(ScalarField(shape, 1), {0, 2}, mode), box);
      EXPECT_EQ(enclosed(ScalarField(shape, 1), {1, 1}, mode), box);
      EXPECT_EQ(enclosed(ScalarField(shape, 1), {0, kInf}, mode), box);
      EXPECT_EQ(enclosed(ScalarField(shape, 3), {0, 2}, mode), 0);
    }
  }
}

TEST(EnclosedVolume, PlaneThroughTheMiddleGivesExactlyTheHalf) {
  const GridShape shape{6, 7, 8};
  EXPECT_EQ(enclosed(plane(shape, 1, 0, 0, -2.5), {0, kInf}), 105);
  EXPECT_EQ(enclosed(plane(shape, 0, 1, 0, -2.5), {-kInf, 0}), 2.5 * 35);
  EXPECT_EQ(enclosed(plane(shape, 0, 0, 1, -3.5), {0, kInf}), 105);
  EXPECT_EQ(enclosed(plane(shape, 1, 0, 0, 0), {1.25f, 3.5f}), 2.25 * 42);
  EXPECT_EQ(enclosed(plane({5, 5, 3}, 1, 1, 0, -4.5), {0, kInf}), 2 * 0.5 * 3.5 * 3.5);
}

TEST(EnclosedVolume, BallHasItsVolume) {
  const double radius = 9.3, expected = 4.0 / 3 * 3.14159265358979 * radius * radius * radius;
  const ScalarField ball = sphere({24, 25, 26}, radius);
  EXPECT_NEAR(enclosed(ball, {0, kInf}), expected, 0.01 * expected);
  EXPECT_NEAR(enclosed(ball, {0, kInf}, BodyMode::sampled), expected, 0.01 * expected);
}

// Smooth fields only: in noise the flat triangles miss much of what a trilinear cell bulges.
TEST(EnclosedVolume, SmoothFieldsAgreeWithSupersampling) {
  Random random(test_seed(2));
  for (const double holes : {0.0, 0.001}) {
    const ScalarField field = with_holes(gyroid({30, 24, 27}, 20), random, holes);
    for (const IsoRange range : {IsoRange{0, kInf}, {-0.5f, 0.5f}, {-kInf, -0.7f}, {0.1f, 0.3f}}) {
      const double fine = supersampled_volume(field, range, BodyMode::exact, 8);
      EXPECT_NEAR(enclosed(field, range), fine, 0.01 * fine) << range.low << " to " << range.high;
    }
  }
}

TEST(EnclosedVolume, BodyAndRestFillTheBox) {
  Random random(test_seed(8));
  for (int trial = 0; trial < 50; ++trial) {
    const ScalarField field = uniform_noise({6, 5, 7}, random, -1, 1);
    const float level = random.between(-0.3f, 0.3f);
    const double sum = enclosed(field, {level, kInf}) + enclosed(field, {-kInf, level});
    EXPECT_NEAR(sum, 5 * 4 * 6, 1e-9) << "trial " << trial;
  }
}

}  // namespace
}  // namespace geosis::test
