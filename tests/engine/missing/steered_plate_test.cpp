#include "engine/missing/plate/steered_plate.h"

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/missing/plate/thin_plate.h"
#include "tests/engine/missing/dense_plate.h"
#include "tests/support/random.h"

namespace geosis {
namespace {

constexpr ThinPlateOptions kAnyValue = {.low = -FLT_MAX, .high = FLT_MAX};
constexpr Vec3d kSteps = {0.2, 0.2, 0.35};

using Field = std::function<double(int, int, int)>;

/// The field's samples; nodes of `hole` are wanted and start from `guess`.
GapBox gap_in(GridShape shape, const Field& field, const GridBox& hole, float guess = 0) {
  GapBox gap{{{}, shape, {}}, {}};
  for (int i = 0; i < shape.inlines; ++i) {
    for (int j = 0; j < shape.crosslines; ++j) {
      for (int k = 0; k < shape.samples; ++k) {
        const bool is_wanted = i >= hole.first.i && i <= hole.last.i && j >= hole.first.j && j <= hole.last.j &&
                               k >= hole.first.k && k <= hole.last.k;
        gap.state.push_back(is_wanted ? NodeState::wanted : NodeState::known);
        gap.samples.value.push_back(is_wanted ? guess : static_cast<float>(field(i, j, k)));
      }
    }
  }
  return gap;
}

GapBox filled(GapBox gap, const ThinPlateOptions& options = kAnyValue, const Vec3d& steps = kSteps) {
  NoProgress progress;
  fill_steered_plate(gap, steps, options, progress);
  return gap;
}

double reflector(double depth) {
  return std::sin(depth / 1.8 + 0.4) + 0.7 * std::sin(depth / 2.9) + 0.5 * std::cos(depth / 4.1 + 1);
}

/// Reflectors that fall by so many samples from inline to inline, and half as many from crossline to crossline.
Field dipping(double dip) {
  return [dip](int i, int j, int k) { return reflector(k - dip * i - 0.5 * dip * j); };
}

/// Root mean square error on wanted nodes.
double error_of(const GapBox& gap, const Field& truth) {
  double sum = 0;
  int count = 0;
  std::size_t n = 0;
  for (int i = 0; i < gap.samples.shape.inlines; ++i) {
    for (int j = 0; j < gap.samples.shape.crosslines; ++j) {
      for (int k = 0; k < gap.samples.shape.samples; ++k, ++n) {
        if (gap.state[n] != NodeState::wanted) continue;
        const double error = gap.samples.value[n] - truth(i, j, k);
        sum += error * error;
        ++count;
      }
    }
  }
  return std::sqrt(sum / count);
}

constexpr GridShape kSurvey = {26, 26, 72};
constexpr GridBox kDeadTraces = {{9, 9, 0}, {16, 16, 71}};  // 8 x 8
constexpr GridBox kInside = {{9, 9, 24}, {16, 16, 47}};

/// Bilinear between the known samples that face each other across the dead traces: interpolation without any dips.
GapBox interpolated_level(GapBox gap, const GridBox& hole) {
  for (int i = hole.first.i; i <= hole.last.i; ++i) {
    for (int j = hole.first.j; j <= hole.last.j; ++j) {
      for (int k = hole.first.k; k <= hole.last.k; ++k) {
        const auto at = [&](int a, int b) { return gap.samples.value[gap.samples.at(a, b, k)]; };
        const auto part = [](int x, int from, int to) {
          return static_cast<float>(x - from) / static_cast<float>(to - from);
        };
        const float u = part(i, hole.first.i - 1, hole.last.i + 1), v = part(j, hole.first.j - 1, hole.last.j + 1);
        const float along = (1 - u) * at(hole.first.i - 1, j) + u * at(hole.last.i + 1, j);
        const float across = (1 - v) * at(i, hole.first.j - 1) + v * at(i, hole.last.j + 1);
        gap.samples.value[gap.samples.at(i, j, k)] = 0.5f * (along + across);
      }
    }
  }
  return gap;
}

TEST(SteeredPlate, ContinuesDippingReflectorsThroughDeadTraces) {
  for (const double dip : {0.5, 1.0, -1.5}) {
    const Field truth = dipping(dip);
    const GapBox level = interpolated_level(gap_in(kSurvey, truth, kDeadTraces), kDeadTraces);
    const double steered = error_of(filled(level), truth), unsteered = error_of(level, truth);
    EXPECT_LT(steered, 0.25 * unsteered) << "dip " << dip << ": " << steered << " of " << unsteered;
  }
}

TEST(SteeredPlate, ContinuesDippingReflectorsThroughAHole) {
  const Field truth = dipping(1);
  const GapBox level = interpolated_level(gap_in(kSurvey, truth, kInside), kInside);
  const double steered = error_of(filled(level), truth);
  EXPECT_LT(steered, 0.15 * error_of(level, truth));
}

TEST(SteeredPlate, GivesFlatReflectorsBack) {
  const Field truth = dipping(0);
  EXPECT_LT(error_of(filled(gap_in(kSurvey, truth, kInside)), truth), 0.04);
}

void expect_is_the_dense_minimum(const GapBox& gap, const Vec3d& steps) {
  const auto found = filled(gap, {.tolerance = 1e-7, .low = -FLT_MAX, .high = FLT_MAX}, steps);
  const auto expected = test::DensePlate(gap, steps).fill();
  std::size_t next = 0;
  for (std::size_t n = 0; n < gap.state.size(); ++n) {
    if (gap.state[n] != NodeState::wanted) continue;
    ASSERT_NEAR(found.samples.value[n], expected[next++], 2e-4) << n;
  }
}

TEST(SteeredPlate, WithoutDipsIsThePlateOnTheGrid) {
  // The same trace everywhere at first sight, so that no dip is found, but with an amplitude that is not flat.
  const Field field = [](int, int, int k) { return std::sin(k / 1.7); };
  expect_is_the_dense_minimum(gap_in({9, 8, 14}, field, {{3, 3, 4}, {5, 5, 9}}), {0.3, 0.2, 0.4});
}

TEST(SteeredPlate, WithoutDipsKeepsAwayFromAbsentNodesAndTheBoxsFaces) {
  const Field field = [](int, int, int k) { return std::sin(k / 1.7); };
  GapBox gap = gap_in({7, 8, 12}, field, {{0, 3, 4}, {2, 5, 11}});
  for (int k = 0; k < 12; ++k) {
    gap.state[gap.samples.at(3, 4, k)] = NodeState::absent;
    gap.samples.value[gap.samples.at(3, 4, k)] = std::numeric_limits<float>::quiet_NaN();
  }
  expect_is_the_dense_minimum(gap, {0.3, 0.3, 0.3});
}

TEST(SteeredPlate, KeepsKnownNodesBitForBit) {
  const GapBox gap = gap_in(kSurvey, dipping(1), kInside);
  const GapBox found = filled(gap);
  for (std::size_t n = 0; n < gap.state.size(); ++n) {
    if (gap.state[n] != NodeState::known) continue;
    ASSERT_EQ(found.samples.value[n], gap.samples.value[n]);
  }
}

TEST(SteeredPlate, StaysInTheRangeAskedFor) {
  const GapBox found = filled(gap_in(kSurvey, dipping(1), kDeadTraces), {.low = -0.25f, .high = 0.5f});
  for (std::size_t n = 0; n < found.state.size(); ++n) {
    if (found.state[n] != NodeState::wanted) continue;
    ASSERT_GE(found.samples.value[n], -0.25f);
    ASSERT_LE(found.samples.value[n], 0.5f);
  }
}

/// The gap with all values times a factor.
GapBox scaled(GapBox gap, float factor) {
  for (float& v : gap.samples.value) v *= factor;
  return gap;
}

TEST(SteeredPlate, ScalesWithTheSamplesUpToTheLargestFloats) {
  const GapBox gap = gap_in(kSurvey, dipping(1), kInside);
  const GapBox once = filled(gap), again = filled(gap);
  EXPECT_EQ(once.samples.value, again.samples.value);
  for (const float factor : {0x1p125f, 0x1p-100f}) {
    EXPECT_EQ(filled(scaled(gap, factor)).samples.value, scaled(once, factor).samples.value) << factor;
  }
}

TEST(SteeredPlate, FillsTheRoughestSamplesWithFiniteOnes) {
  const std::uint64_t seed = test::test_seed(11);
  SCOPED_TRACE("seed " + std::to_string(seed));
  test::Random random(seed);
  for (const GridShape shape : {GridShape{1, 1, 5}, {2, 9, 1}, {6, 1, 3}, {5, 5, 2}, {9, 9, 9}}) {
    const Field rough = [&](int, int, int) { return random.unit() < 0.5 ? -FLT_MAX : FLT_MAX; };
    GapBox gap = gap_in(shape, rough, {{0, 0, 0}, {-1, -1, -1}});
    for (NodeState& state : gap.state) {
      const int draw = random.integer(0, 3);
      state = draw == 0 ? NodeState::absent : draw == 1 ? NodeState::known : NodeState::wanted;
    }
    const GapBox found = filled(gap);
    for (std::size_t n = 0; n < found.state.size(); ++n) ASSERT_TRUE(std::isfinite(found.samples.value[n]));
  }
}

TEST(SteeredPlate, FillsTracesTooShortForDipsAsTheLevelPlate) {
  test::Random random(test::test_seed(12));
  const Field noise = [&](int, int, int) { return random.between(-1, 1); };
  for (const int samples : {1, 2, 3}) {
    GapBox gap = gap_in({6, 7, samples}, noise, {{0, 0, 0}, {-1, -1, -1}});
    for (NodeState& state : gap.state) state = random.integer(0, 2) == 0 ? NodeState::wanted : NodeState::known;
    GapBox level = gap;
    fill_thin_plate(level, kSteps, kAnyValue, NoProgress());
    EXPECT_EQ(filled(gap).samples.value, level.samples.value) << samples << " samples";
  }
}

/// Says no after so many questions.
class CancelledAfter final : public Progress {
 public:
  explicit CancelledAfter(int questions) : left_(questions) {}
  void report(const char*, double) override {}
  bool cancelled() const override { return left_-- <= 0; }

 private:
  mutable int left_;
};

TEST(SteeredPlate, ACancelledFillLeavesTheGapAsItWas) {
  const GapBox gap = gap_in(kSurvey, dipping(1), kInside);
  for (const int questions : {0, 5, 20, 40}) {
    GapBox filling = gap;
    fill_steered_plate(filling, kSteps, kAnyValue, CancelledAfter(questions));
    EXPECT_EQ(filling.samples.value, gap.samples.value) << questions;
  }
}

TEST(WantsSteering, IsDecidedByWidthAndPlanarity) {
  NoProgress progress;
  const auto wants = [&](const GapBox& gap, FillSteering steering) { return wants_steering(gap, steering, progress); };
  const GapBox wide = gap_in(kSurvey, dipping(1), kInside);
  const GapBox narrow = gap_in(kSurvey, dipping(1), {{9, 0, 0}, {11, 25, 71}});
  const GapBox enough = gap_in(kSurvey, dipping(1), {{9, 5, 10}, {12, 8, 10}});
  test::Random random(3);
  const GapBox noise = gap_in(
      kSurvey, [&](int, int, int) { return random.unit(); }, kInside);
  EXPECT_TRUE(wants(wide, FillSteering::automatic));
  EXPECT_TRUE(wants(enough, FillSteering::automatic));
  EXPECT_FALSE(wants(narrow, FillSteering::automatic));
  EXPECT_FALSE(wants(noise, FillSteering::automatic));
  EXPECT_FALSE(wants(wide, FillSteering::off));
  EXPECT_TRUE(wants(noise, FillSteering::on));
}

}  // namespace
}  // namespace geosis
