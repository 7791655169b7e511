#include "engine/analysis/surface_distance.h"

#include <random>
#include <string>

#include <gtest/gtest.h>

#include "tests/support/lattice_meshes.h"

namespace geosis {
namespace {

TEST(MeasureDistance, ParallelPlates) {
  const SurfaceDistance distance = measure_distance(test::sheet(10, 3), test::sheet(7, 5.5f, 10.0f / 7), {});
  EXPECT_NEAR(distance.mean_voxels, 2.5, 1e-6);
  EXPECT_NEAR(distance.max_voxels, 2.5, 1e-6);
  EXPECT_EQ(distance.samples, 20'000);
}

TEST(MeasureDistance, ConcentricSpheres) {
  const SurfaceDistance distance =
      measure_distance(test::sphere({50, 50, 50}, 30, 100, 200), test::sphere({50, 50, 50}, 32, 100, 200), {});
  EXPECT_NEAR(distance.mean_voxels, 2, 0.02);
  EXPECT_NEAR(distance.max_voxels, 2, 0.05);
}

TEST(MeasureDistance, SameSurfaceIsAtDistanceZero) {
  const IndexedMesh torus = test::torus({32, 32, 32}, 15, 6, 30, 20);
  const SurfaceDistance distance = measure_distance(torus, torus, {});
  EXPECT_LT(distance.max_voxels, 1e-6);
}

TEST(MeasureDistance, MeanIsTheMeanOfBothSides) {
  IndexedMesh two_plates = test::sheet(10, 0);
  test::append(two_plates, test::sheet(10, 4));  // half of its area is 4 away from the one plate, which touches it
  const SurfaceDistance distance = measure_distance(test::sheet(10, 0), two_plates, {});
  EXPECT_NEAR(distance.mean_voxels, (0 + 2) / 2.0, 1e-6);
  EXPECT_NEAR(distance.max_voxels, 4, 1e-6);
}

/// A peak on one vertex in ten thousand: points by area would miss its tip.
TEST(MeasureDistance, VerticesThatStickOutAreSeen) {
  IndexedMesh peaked = test::sheet(60, 0);
  for (Vec3f& p : peaked.positions) p.z = p.x == 30 && p.y == 30 ? 9.0f : 0.0f;
  EXPECT_EQ(measure_distance(test::sheet(60, 0), peaked, {}).max_voxels, 9);
  EXPECT_EQ(measure_distance(peaked, test::sheet(60, 0), {}).max_voxels, 9);
}

TEST(MeasureDistance, IsSymmetricAndTheSameOnAnyNumberOfThreads) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  for (int round = 0; round < 10; ++round) {
    const IndexedMesh a = test::random_shapes(random, 4), b = test::random_shapes(random, 3);
    const SurfaceDistance there = measure_distance(a, b, {.samples = 2'000}),
                          back = measure_distance(b, a, {.samples = 2'000, .threads = 4});
    EXPECT_EQ(there.mean_voxels, back.mean_voxels);
    EXPECT_EQ(there.max_voxels, back.max_voxels);
    EXPECT_GT(there.mean_voxels, 0);
    EXPECT_GE(there.max_voxels, there.mean_voxels);
  }
}

TEST(MeasureDistance, NothingIsMeasuredWithoutTriangles) {
  for (const auto& distance :
       {measure_distance({}, test::sheet(2, 0), {}), measure_distance(test::sheet(2, 0), {}, {})}) {
    EXPECT_EQ(distance.samples, 0);
    EXPECT_EQ(distance.max_voxels, 0);
  }
}

TEST(MeasureDistance, OneSampleIsEnough) {
  EXPECT_NEAR(measure_distance(test::sheet(2, 0), test::sheet(2, 1), {.samples = 1}).mean_voxels, 1, 1e-6);
}

}  // namespace
}  // namespace geosis
