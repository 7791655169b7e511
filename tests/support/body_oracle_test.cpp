#include "tests/support/body_oracle.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tests/support/phantoms.h"
#include "tests/support/supersampling.h"

// The oracle that judges the extractor is itself judged: by phantoms whose topology is known, and by brute force.

namespace geosis::test {

std::ostream& operator<<(std::ostream& out, const SurfaceTopology& t) {
  return out << "euler " << t.euler << ", components " << t.components << (t.decided ? "" : ", undecided");
}

namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();

SurfaceTopology closed(std::int64_t euler, std::int64_t components) {
  return {true, euler, components};
}

TEST(ExpectedSurface, BallIsASphere) {
  EXPECT_EQ(expected_surface(sphere({12, 11, 13}, 4), {0, kInf}, BodyMode::exact), closed(2, 1));
}

TEST(ExpectedSurface, BallCutByTheSurveyBorderIsASphere) {
  EXPECT_EQ(expected_surface(sphere({9, 9, 5}, 4), {0, kInf}, BodyMode::exact), closed(2, 1));
}

TEST(ExpectedSurface, SolidTorusHasAHole) {
  EXPECT_EQ(expected_surface(torus({20, 20, 9}, 6, 2.2), {0, kInf}, BodyMode::exact), closed(0, 1));
}

TEST(ExpectedSurface, TwoTunnelsMakeGenusTwo) {
  EXPECT_EQ(expected_surface(two_tunnels({20, 20, 20}, 7, 1.6), {0, kInf}, BodyMode::exact), closed(-2, 1));
}

TEST(ExpectedSurface, HollowBallHasACavity) {
  EXPECT_EQ(expected_surface(shell({16, 16, 16}, 6.5, 2.5), {0, kInf}, BodyMode::exact), closed(4, 2));
  EXPECT_EQ(expected_surface(sphere({16, 16, 16}, 6.5), {0, 2.5f}, BodyMode::exact), closed(4, 2));
}

TEST(ExpectedSurface, TwoSheetsAreTwoBoxes) {
  EXPECT_EQ(expected_surface(two_sheets({8, 8, 12}, 4), {0, 1}, BodyMode::exact), closed(4, 2));
}

TEST(ExpectedSurface, ThinSheetInsideCellsIsFound) {
  EXPECT_EQ(expected_surface(plane({6, 6, 6}, 1, 0, 0, 0), {2.4f, 2.5f}, BodyMode::exact), closed(2, 1));
  EXPECT_EQ(expected_surface(plane({6, 6, 6}, 1, 0, 0, 0), {2.4f, 2.4f}, BodyMode::exact), closed(2, 1));
  EXPECT_EQ(expected_surface(plane({6, 6, 6}, 1, 0, 0, 0), {2.4f, 2.5f}, BodyMode::sampled), closed(0, 0));
}

TEST(ExpectedSurface, EverythingOrNothingInRange) {
  const ScalarField field({4, 5, 6}, 1.0f);
  EXPECT_EQ(expected_surface(field, {0, 2}, BodyMode::exact), closed(2, 1));
  EXPECT_EQ(expected_surface(field, {1, 1}, BodyMode::exact), closed(2, 1));
  EXPECT_EQ(expected_surface(field, {2, 3}, BodyMode::exact), closed(0, 0));
  EXPECT_EQ(expected_surface(field, {-3, 0}, BodyMode::exact), closed(0, 0));
}

TEST(ExpectedSurface, MissingSampleInsideIsACavityOfTwoByTwoByTwoCells) {
  ScalarField field({7, 7, 7}, 1.0f);
  field.at({3, 3, 3}) = std::nanf("");
  EXPECT_EQ(expected_surface(field, {0, kInf}, BodyMode::exact), closed(4, 2));
}

TEST(ExpectedSurface, CellsThatMeetInACornerAreTwoBodies) {
  ScalarField field({3, 3, 3}, 1.0f);
  for (const GridIndex n : {GridIndex{2, 0, 0}, {0, 2, 0}, {0, 0, 2}}) field.at(n) = std::nanf("");
  for (const GridIndex n : {GridIndex{2, 2, 0}, {0, 2, 2}, {2, 0, 2}}) field.at(n) = std::nanf("");
  EXPECT_EQ(expected_surface(field, {0, kInf}, BodyMode::exact), closed(4, 2));
}

TEST(ExpectedSurface, SampleOnTheEndOfTheRangeIsABodyOfItsOwn) {
  ScalarField field({5, 5, 5}, -1.0f);
  field.at({2, 2, 2}) = 0;
  EXPECT_EQ(expected_surface(field, {0, kInf}, BodyMode::exact), closed(2, 1));
  EXPECT_EQ(expected_surface(field, {0, 0}, BodyMode::exact), closed(2, 1));
  EXPECT_EQ(expected_surface(field, {0, 1}, BodyMode::sampled), closed(2, 1));
}

TEST(ExpectedSurface, SaddleOnTheLevelIsUndecided) {
  ScalarField field({2, 2, 2}, -1.0f);
  field.at({0, 0, 0}) = field.at({0, 1, 1}) = 1;
  EXPECT_FALSE(expected_surface(field, {0, kInf}, BodyMode::exact).decided);
  EXPECT_TRUE(expected_surface(field, {0.125f, kInf}, BodyMode::exact).decided);
}

TEST(ExpectedSurface, ExactlyASaddleOnTheLevelJoinsTheBody) {
  ScalarField field({2, 2, 2}, -1.0f);
  field.at({0, 0, 0}) = field.at({0, 1, 1}) = 1;
  EXPECT_EQ(expected_surface(field, {0, kInf}, BodyMode::exact, Arithmetic::exact), closed(2, 1));
  EXPECT_EQ(expected_surface(field, {-kInf, 0}, BodyMode::exact, Arithmetic::exact), closed(2, 1));
  field.at({1, 0, 0}) = field.at({1, 1, 1}) = 1;
  EXPECT_EQ(expected_surface(field, {0, 0}, BodyMode::exact, Arithmetic::exact), closed(2, 1));
}

TEST(ExpectedSurface, ExactlyIsWhatRoundedArithmeticDecides) {
  Random random(test_seed(12));
  for (int trial = 0; trial < 50; ++trial) {
    const ScalarField field = with_holes(uniform_noise({4, 4, 4}, random, -1, 1), random, 0.02);
    const IsoRange range{random.between(-0.4f, 0), random.between(0, 0.4f)};
    for (const BodyMode mode : {BodyMode::exact, BodyMode::sampled}) {
      const SurfaceTopology rounded = expected_surface(field, range, mode);
      if (!rounded.decided) continue;
      ASSERT_EQ(rounded, expected_surface(field, range, mode, Arithmetic::exact)) << "trial " << trial;
    }
  }
}

// Turns a field of one cell; the sweep along another axis computes other numbers.
ScalarField turned(const ScalarField& field) {
  ScalarField other(field.shape);
  for_each_node(field.shape, [&](GridIndex n) { other.at({n.j, n.k, n.i}) = field.at(n); });
  return other;
}

TEST(ExpectedSurface, ExactlyItDoesNotDependOnTheOrderOfAxesForAnySamples) {
  Random random(test_seed(13));
  for (int trial = 0; trial < 60; ++trial) {
    ScalarField field = uniform_noise({2, 2, 2}, random, -1, 1);
    for (float& f : field.samples) f *= std::ldexp(1.0f, random.integer(-126, 126));
    const ScalarField plateaus = integer_noise({2, 2, 2}, random, -1, 1);
    for (const IsoRange range : {IsoRange{0, kInf}, {-1e-20f, 1e10f}, {0, 0}})
      for (const BodyMode mode : {BodyMode::exact, BodyMode::sampled})
        for (const ScalarField& samples : {field, plateaus})
          ASSERT_EQ(expected_surface(samples, range, mode, Arithmetic::exact),
                    expected_surface(turned(samples), range, mode, Arithmetic::exact))
              << "trial " << trial;
  }
}

TEST(ExpectedSurface, AnswerDoesNotDependOnTheOrderOfAxes) {
  Random random(test_seed(11));
  for (int trial = 0; trial < 2000; ++trial) {
    const ScalarField field = uniform_noise({2, 2, 2}, random, -1, 1);
    const IsoRange range{random.between(-0.4f, 0), random.between(0, 0.4f)};
    for (const BodyMode mode : {BodyMode::exact, BodyMode::sampled})
      ASSERT_EQ(expected_surface(field, range, mode), expected_surface(turned(field), range, mode))
          << "trial " << trial;
  }
}

// The oracle must equal brute force at two refinements in a row; how fine that has to be depends on the field.
bool agrees_with_supersampling(const ScalarField& field, IsoRange range, BodyMode mode, int finest) {
  const SurfaceTopology expected = expected_surface(field, range, mode);
  bool before = false;
  for (int refinement = 12; refinement <= finest; refinement *= 2) {
    const bool now = supersampled_surface(field, range, mode, refinement) == expected;
    if (before && now) return true;
    before = now;
  }
  return false;
}

// Samples near an end of the range cut off corners smaller than a voxel: they move away from it.
ScalarField away_from_ends(ScalarField field, IsoRange range) {
  constexpr float kGap = 0.12f;
  for (float& f : field.samples)
    for (const float end : {range.low, range.high})
      if (std::abs(f - end) < kGap) f = f < end ? end - kGap : end + kGap;
  return field;
}

struct Sampling {
  GridShape shape;
  BodyMode mode;
  bool two_sided;
  double holes;
  int trials, finest;
  int may_differ;  // fields with a neck or a tunnel thinner than the finest voxel
};

void expect_brute_force_agrees(const Sampling& p) {
  Random random(7);  // fixed: other fields may have finer necks
  int differ = 0;
  for (int trial = 0; trial < p.trials; ++trial) {
    const IsoRange range{random.between(-0.6f, -0.1f), p.two_sided ? random.between(0.2f, 0.8f) : kInf};
    const ScalarField field = with_holes(uniform_noise(p.shape, random, -1, 1), random, p.holes);
    differ += !agrees_with_supersampling(away_from_ends(field, range), range, p.mode, p.finest);
  }
  EXPECT_LE(differ, p.may_differ) << "of " << p.trials;
}

TEST(ExpectedSurface, EqualsBruteForceInRandomCells) {
  expect_brute_force_agrees({{2, 2, 2}, BodyMode::exact, false, 0, 300, 96, 0});
}

TEST(ExpectedSurface, EqualsBruteForceInRandomCellsOfABand) {
  expect_brute_force_agrees({{2, 2, 2}, BodyMode::exact, true, 0, 400, 96, 2});
}

TEST(ExpectedSurface, EqualsBruteForceInRandomFields) {
  expect_brute_force_agrees({{3, 3, 4}, BodyMode::exact, false, 0, 12, 96, 1});
  expect_brute_force_agrees({{3, 3, 4}, BodyMode::exact, true, 0, 12, 96, 1});
}

TEST(ExpectedSurface, EqualsBruteForceInRandomFieldsWithHoles) {
  expect_brute_force_agrees({{5, 5, 4}, BodyMode::exact, true, 0.05, 8, 48, 1});
}

// Samples are multiples of 1/64, so that their products are exact in float32.
TEST(ExpectedSurface, SampledModeIsTheExactModeOfTheProduct) {
  Random random(test_seed(3));
  constexpr float kLow = -0.25f, kHigh = 0.5f;
  for (int trial = 0; trial < 300; ++trial) {
    ScalarField field = integer_noise({4, 4, 4}, random, -64, 64);
    for (float& f : field.samples) f /= 64;
    ScalarField product = field;
    for (float& f : product.samples) f = (f - kLow) * (kHigh - f);
    const SurfaceTopology sampled = expected_surface(field, {kLow, kHigh}, BodyMode::sampled);
    ASSERT_EQ(sampled, expected_surface(product, {0, kInf}, BodyMode::exact)) << "trial " << trial;
  }
}

TEST(ExpectedSurface, OneOpenEndMakesBothModesEqual) {
  Random random(test_seed(4));
  for (int trial = 0; trial < 300; ++trial) {
    const ScalarField field = uniform_noise({4, 4, 4}, random, -1, 1);
    for (const IsoRange range : {IsoRange{0.1f, kInf}, IsoRange{-kInf, 0.1f}})
      ASSERT_EQ(expected_surface(field, range, BodyMode::sampled), expected_surface(field, range, BodyMode::exact))
          << "trial " << trial;
  }
}

TEST(ExpectedSurface, RangeWithoutWidthEqualsANarrowOne) {
  Random random(test_seed(6));
  int compared = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const ScalarField field = integer_noise({4, 4, 4}, random, -5, 5);
    const SurfaceTopology level = expected_surface(field, {1, 1}, BodyMode::exact);
    if (!level.decided) continue;
    ++compared;
    ASSERT_EQ(level, expected_surface(field, {1 - 1e-5f, 1 + 1e-5f}, BodyMode::exact)) << "trial " << trial;
  }
  EXPECT_GT(compared, 30);
}

TEST(ExpectedSurface, CellsDroppedAtOppositeSidesOfANodeAreTwoCavities) {
  ScalarField field({9, 9, 9}, 1.0f);
  field.at({3, 3, 3}) = field.at({5, 5, 5}) = std::nanf("");
  EXPECT_EQ(expected_surface(field, {0, kInf}, BodyMode::exact), closed(6, 3));
  field.at({4, 4, 4}) = -1;
  EXPECT_EQ(expected_surface(field, {0, kInf}, BodyMode::exact), closed(4, 2));
}

TEST(ExpectedOpenSurface, BallInsideIsClosedAndCutByTheBorderIsADisc) {
  EXPECT_EQ(expected_open_surface(sphere({12, 11, 13}, 4), {0, kInf}, BodyMode::exact).euler, 2);
  EXPECT_EQ(expected_open_surface(sphere({5, 11, 13}, 4), {0, kInf}, BodyMode::exact).euler, 0);
  EXPECT_EQ(expected_open_surface(plane({5, 6, 7}, 1, 1, 0, -2.5), {0, kInf}, BodyMode::exact).euler, 1);
  EXPECT_EQ(expected_open_surface(plane({5, 6, 7}, 1, 1, 0, -2.5), {0, 2}, BodyMode::exact).euler, 2);
}

TEST(ExpectedOpenSurface, EqualsTheClosedOneInsideAnEmptyLayer) {
  Random random(test_seed(5));
  for (int trial = 0; trial < 300; ++trial) {
    const ScalarField field = with_outer_layer(uniform_noise({5, 5, 5}, random, -1, 1), -2);
    const IsoRange range{random.between(-0.3f, 0), random.between(0, 0.3f)};
    for (const BodyMode mode : {BodyMode::exact, BodyMode::sampled})
      ASSERT_EQ(expected_open_surface(field, range, mode).euler, expected_surface(field, range, mode).euler)
          << "trial " << trial;
  }
}

}  // namespace
}  // namespace geosis::test
