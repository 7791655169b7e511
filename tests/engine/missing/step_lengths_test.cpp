#include "engine/missing/step_lengths.h"

#include <algorithm>
#include <cmath>

#include "engine/missing/gaps/survey_scan.h"
#include "tests/engine/missing/fill_oracle.h"
#include "tests/engine/missing/gappy_fields.h"

namespace geosis {
namespace {

Vec3d steps_of(const test::ScalarField& field) {
  const auto volume = test::volume_of(field);
  NoProgress unwatched;
  const auto scan = scan_survey(*volume, 1, unwatched);
  EXPECT_TRUE(scan);
  return scan ? scan->step_lengths : Vec3d{};
}

void expect_steps(const test::ScalarField& field, std::array<double, 3> expected) {
  const Vec3d steps = steps_of(field);
  for (int axis = 0; axis < 3; ++axis)
    EXPECT_NEAR(steps[axis], expected[static_cast<std::size_t>(axis)], 1e-9 * expected[static_cast<std::size_t>(axis)])
        << axis;
}

TEST(StepLengths, CountEveryPairOnceAlthoughBricksShareLayers) {
  test::Random random(2);
  for (const GridShape shape : {GridShape{65, 66, 3}, GridShape{2, 3, 130}, GridShape{64, 5, 64}})
    for (const double missing : {0.0, 0.3}) {
      const auto field = test::with_holes(test::uniform_noise(shape, random, 1000, 1004), random, missing);
      expect_steps(field, test::measure_steps(field));
    }
}

TEST(StepLengths, TakeEverySecondSampleWhereNoneAreNeighbours) {
  test::Random random(4);
  test::ScalarField field = test::uniform_noise({9, 11, 20}, random, 0, 1);
  for (std::int32_t i = 1; i < 9; i += 2)
    for (std::int32_t j = 0; j < 11; ++j) field = test::without_trace(std::move(field), i, j);
  expect_steps(field, test::measure_steps(field));
}

TEST(StepLengths, TakeTheLargestOfTheOthersWithoutPairs) {
  test::Random random(4);
  const Vec3d steps = steps_of(test::uniform_noise({1, 11, 20}, random, 0, 1));
  EXPECT_EQ(steps.x, std::max(steps.y, steps.z));
}

TEST(StepLengths, StayWithinATwentiethOfTheLargest) {
  test::ScalarField field(GridShape{8, 8, 8});
  test::for_each_node(
      field.shape, [&](GridIndex n) { field.at(n) = static_cast<float>(n.k % 2) + 1e-4f * static_cast<float>(n.i); });
  const Vec3d steps = steps_of(field);
  EXPECT_NEAR(steps.x, steps.z / 20, 1e-12);
  EXPECT_NEAR(steps.y, steps.z / 20, 1e-12);
}

TEST(StepLengths, AreOneInConstantFields) {
  EXPECT_EQ(steps_of(test::ScalarField(GridShape{4, 4, 4}, 3)), (Vec3d{1, 1, 1}));
}

}  // namespace
}  // namespace geosis
