#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "engine/base/progress.h"
#include "engine/pipeline/reconstruct.h"
#include "engine/volume/brick_file.h"
#include "tests/support/phantoms.h"

// Values at the ends of what float32 holds, all the way to certified levels: every number of the certificate is finite.

namespace geosis::test {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr float kMax = std::numeric_limits<float>::max();

void expect_sound_levels(const ScalarField& field, IsoRange range, const FillOptions& fill = {}) {
  const auto volume = make_bricked_volume(field.shape, field.samples);
  for (const BodyMode mode : {BodyMode::exact, BodyMode::sampled}) {
    NoProgress progress;
    const auto result =
        reconstruct({*volume, AffineGeometry()},
                    {.range = range, .mode = mode, .fill = fill, .levels = by_ratio({1, 0.25})}, progress);
    ASSERT_TRUE(result) << result.error().message;
    for (const ReconstructedLevel& level : result->levels) {
      EXPECT_TRUE(level.topology.manifold);
      EXPECT_EQ(level.topology.boundary_loops, 0);
      for (const double number : {level.measures.area, level.measures.volume, level.distance.mean_voxels,
                                  level.distance.max_voxels, level.volume_drift, level.lod.cost}) {
        EXPECT_TRUE(std::isfinite(number)) << "range " << range.low << " to " << range.high;
      }
    }
  }
}

ScalarField noise(Random& random, float scale) {
  ScalarField field = uniform_noise({6, 6, 6}, random, -1, 1);
  for (float& f : field.samples) f *= scale;
  return field;
}

TEST(WholeWay, ConstantVolumes) {
  for (const IsoRange range : {IsoRange{7, 7}, {5, 9}, {-kInf, kInf}, {8, 9}, {kInf, kInf}})
    expect_sound_levels(ScalarField({5, 4, 3}, 7), range);
}

TEST(WholeWay, AllSamplesMissing) {
  expect_sound_levels(ScalarField({4, 4, 4}, std::numeric_limits<float>::quiet_NaN()), {-kInf, kInf});
}

TEST(WholeWay, SlabsAndNarrowRanges) {
  Random random(test_seed(21));
  expect_sound_levels(noise(random, 1), {0.1f, 0.1f});
  expect_sound_levels(noise(random, 1), {0.1f, std::nextafter(0.1f, 1.0f)});
  expect_sound_levels(integer_noise({6, 5, 4}, random, 0, 2), {1, 1});
}

TEST(WholeWay, SmallestAndLargestSamples) {
  Random random(test_seed(22));
  expect_sound_levels(noise(random, 1e-40f), {-2e-41f, 3e-41f});
  expect_sound_levels(noise(random, kMax), {-0.3f * kMax, 0.4f * kMax});
  expect_sound_levels(noise(random, kMax), {-kMax, kMax});
}

TEST(WholeWay, SmallestAndLargestSamplesWithHoles) {
  Random random(test_seed(23));
  for (const float scale : {1e-40f, 1.0f, kMax}) {
    const ScalarField field = with_holes(noise(random, scale), random, 0.2);
    for (const FillOptions& fill : {FillOptions{}, FillOptions{FillMethod::linear}, FillOptions{FillMethod::rbf},
                                    FillOptions{FillMethod::rbf, RbfKernel::polyharmonic, FillSteering::on},
                                    FillOptions{FillMethod::rbf, RbfKernel::inverse_distance}})
      expect_sound_levels(field, {-0.3f * scale, 0.4f * scale}, fill);
  }
}

}  // namespace
}  // namespace geosis::test
