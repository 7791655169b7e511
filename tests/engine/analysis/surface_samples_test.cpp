#include "engine/analysis/surface_samples.h"

#include <algorithm>
#include <cstdint>

#include <gtest/gtest.h>

#include "tests/support/lattice_meshes.h"

namespace geosis {
namespace {

TEST(SampleSurface, EqualAreasGetEqualNumbersOfPoints) {
  // One triangle of area 24 beside 12 small ones: in any order, three quarters of the points lie on the large one.
  IndexedMesh mesh = test::sheet(2, 0);
  test::append(mesh, {{{0, 0, 1}, {6, 0, 1}, {0, 8, 1}}, {{0, 1, 2}}});
  const SurfaceSamples samples = sample_surface(mesh, 7'012);
  ASSERT_EQ(samples.vertices, mesh.positions.size());
  const auto on_large =
      std::count_if(samples.points.begin() + 12, samples.points.end(), [](const Vec3d& p) { return p.z > 0.5; });
  EXPECT_NEAR(static_cast<double>(on_large), 6'000, 1);
}

TEST(SampleSurface, PointsFillALargeTriangleEvenly) {
  const IndexedMesh mesh = {{{0, 0, 0}, {8, 0, 0}, {0, 8, 0}}, {{0, 1, 2}}};
  const SurfaceSamples samples = sample_surface(mesh, 8'003);
  double x = 0, y = 0;
  for (std::size_t s = samples.vertices; s < samples.points.size(); ++s)
    x += samples.points[s].x, y += samples.points[s].y;
  EXPECT_NEAR(x / 8'000, 8.0 / 3, 0.02);  // the centroid
  EXPECT_NEAR(y / 8'000, 8.0 / 3, 0.02);
  const auto near_corner =
      std::count_if(samples.points.begin() + 3, samples.points.end(), [](const Vec3d& p) { return p.x + p.y < 4; });
  EXPECT_NEAR(static_cast<double>(near_corner), 2'000, 40);  // a quarter of the area
}

TEST(SampleSurface, AtMostHalfAreVertices) {
  const SurfaceSamples samples = sample_surface(test::sheet(50, 0), 100);
  EXPECT_EQ(samples.vertices, 50u);
  EXPECT_EQ(samples.points.size(), 100u);
}

TEST(SampleSurface, SurfaceWithoutAreaStillHasPoints) {
  const IndexedMesh mesh = {{{1, 1, 1}, {1, 1, 1}, {1, 1, 1}}, {{0, 1, 2}}};
  for (const Vec3d& p : sample_surface(mesh, 10).points) EXPECT_EQ(p, (Vec3d{1, 1, 1}));
}

}  // namespace
}  // namespace geosis
