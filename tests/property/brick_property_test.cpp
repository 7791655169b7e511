#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "engine/base/progress.h"
#include "engine/volume/brick_file.h"
#include "tests/property/surface_laws.h"
#include "tests/support/phantoms.h"

// Laws of extract_body where the body crosses bricks, and where the region is a part of the volume.

namespace geosis::test {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();

void expect_all_laws(const ScalarField& field, IsoRange range, BodyMode mode) {
  for (const auto judge : {judge_closed_surface, judge_open_surface, judge_decoded_surface, judge_threads}) {
    const Verdict verdict = judge(field, range, mode);
    EXPECT_EQ(verdict.broken, "");
    EXPECT_TRUE(verdict.decided);
  }
}

TEST(ExtractBodyOverBricks, NoiseKeepsEveryLaw) {
  Random random(test_seed(21));
  const ScalarField field = uniform_noise({66, 9, 130}, random, -1, 1);
  expect_all_laws(field, {-0.1f, 0.35f}, BodyMode::exact);
  expect_all_laws(field, {-0.1f, 0.35f}, BodyMode::sampled);
}

TEST(ExtractBodyOverBricks, NoiseWithHolesKeepsEveryLaw) {
  Random random(test_seed(22));
  const ScalarField field = with_holes(uniform_noise({9, 129, 66}, random, -1, 1), random, 0.02);
  expect_all_laws(field, {0.2f, kInf}, BodyMode::exact);
}

TEST(ExtractBodyOverBricks, GyroidWithHolesKeepsEveryLaw) {
  Random random(test_seed(23));
  const ScalarField field = with_holes(gyroid({70, 66, 130}, 17.3), random, 0.0005);
  expect_all_laws(field, {-0.3f, 0.6f}, BodyMode::exact);
}

// Seams of bricks lie at nodes 63 and 126: dropped cells on both sides of each.
TEST(ExtractBodyOverBricks, HolesOnTheSeamsKeepEveryLaw) {
  Random random(test_seed(24));
  ScalarField field = uniform_noise({5, 128, 128}, random, -0.2f, 1);
  for_each_node(field.shape, [&](GridIndex n) {
    const bool near_seam = (n.j + 1) % 63 <= 2 || (n.k + 1) % 63 <= 2;
    if (near_seam && random.unit() < 0.1) field.at(n) = std::numeric_limits<float>::quiet_NaN();
  });
  expect_all_laws(field, {0, kInf}, BodyMode::exact);
}

TEST(ExtractBodyOverBricks, LongThinVolumesKeepEveryLaw) {
  Random random(test_seed(25));
  for (const GridShape shape : {GridShape{2, 2, 200}, {200, 2, 3}, {2, 200, 2}, {64, 64, 2}, {65, 2, 64}})
    expect_all_laws(uniform_noise(shape, random, -1, 1), {-0.2f, 0.4f}, BodyMode::exact);
}

// A region's surface is the surface of the cropped field, moved by the region's first node.
TEST(ExtractBodyOfARegion, HasTheSurfaceOfTheCroppedField) {
  Random random(test_seed(26));
  const ScalarField field = with_holes(uniform_noise({12, 70, 68}, random, -1, 1), random, 0.01);
  const auto volume = make_bricked_volume(field.shape, field.samples);
  const IsoRange range{-0.2f, 0.5f};
  for (int trial = 0; trial < 12; ++trial) {
    GridBox region;
    for (int axis = 0; axis < 3; ++axis) {
      region.first[axis] = random.integer(0, field.shape[axis] - 2);
      region.last[axis] = random.integer(region.first[axis] + 1, field.shape[axis] - 1);
    }
    NoProgress progress;
    const auto mesh = extract_body(*volume, range, {.region = region}, progress);
    ASSERT_TRUE(mesh) << mesh.error().message;
    const MeshCensus found = census(*mesh);
    const MeshCensus cropped = census(extract_surface(crop(field, region), range, BodyMode::exact));
    EXPECT_TRUE(found.is_closed_manifold()) << found;
    EXPECT_EQ(found.euler(), cropped.euler());
    EXPECT_EQ(found.components, cropped.components);
    EXPECT_EQ(found.triangles, cropped.triangles);
    EXPECT_NEAR(found.volume, cropped.volume, 1e-6 * cropped.volume);
  }
}

}  // namespace
}  // namespace geosis::test
