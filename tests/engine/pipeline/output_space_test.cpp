#include "engine/pipeline/output_space.h"

#include <gtest/gtest.h>

namespace geosis {
namespace {

const AffineGeometry kSurvey({600'000, 6'000'000, 1000}, {25, 5, 0}, {-5, 25, 0}, {0, 0, 4});

TEST(OutputSpace, IsTheWorldUnlessIndexSpaceIsAskedFor) {
  EXPECT_EQ(*output_space(kSurvey, {})->affine(), *kSurvey.affine());
  EXPECT_EQ(*output_space(kSurvey, {.index_space = true})->affine(), *AffineGeometry().affine());
}

TEST(OutputSpace, TurnsTwoWayTimeIntoDepth) {
  const auto space = output_space(kSurvey, {.velocity = 2500});
  const Vec3d top = space->map({0, 0, 0}), below = space->map({0, 0, 10});
  EXPECT_DOUBLE_EQ(top.z, 1250);  // 1000 ms down and up at 2500 m/s
  EXPECT_DOUBLE_EQ(below.z - top.z, 50);
  EXPECT_DOUBLE_EQ(below.x, 600'000);
  EXPECT_DOUBLE_EQ(space->map({2, 0, 0}).x, 600'050);
}

}  // namespace
}  // namespace geosis
