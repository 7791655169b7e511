#include "engine/analysis/surface_measures.h"

#include <numbers>

#include <gtest/gtest.h>

#include "tests/support/lattice_meshes.h"

namespace geosis {
namespace {

const IndexedMesh kBox = test::box({1, 2, 3}, {3, 6, 3.5f});  // 2 x 4 x 0.5

TEST(MeasureSurface, BoxInIndexSpace) {
  const SurfaceMeasures box = measure_surface(kBox, AffineGeometry());
  EXPECT_DOUBLE_EQ(box.area, 2 * (2 * 4 + 4 * 0.5 + 2 * 0.5));
  EXPECT_DOUBLE_EQ(box.volume, 4);
}

TEST(MeasureSurface, StepsOfTheGridScaleAreaAndVolume) {
  const SurfaceMeasures box = measure_surface(kBox, AffineGeometry({5, 6, 7}, {25, 0, 0}, {0, 12.5, 0}, {0, 0, 4}));
  EXPECT_DOUBLE_EQ(box.area, 2 * (50 * 50 + 50 * 2 + 50 * 2));
  EXPECT_DOUBLE_EQ(box.volume, 4 * 25 * 12.5 * 4);
}

TEST(MeasureSurface, FarOriginCostsNoDigits) {
  const Vec3d i = {17.1, 3.3, 0}, j = {-2.9, 11.7, 0}, k = {0, 0, 4};
  const SurfaceMeasures near = measure_surface(kBox, AffineGeometry({0, 0, 0}, i, j, k));
  const SurfaceMeasures far = measure_surface(kBox, AffineGeometry({654'321.7, 6'543'210.3, -12'345.6}, i, j, k));
  EXPECT_EQ(near.area, far.area);
  EXPECT_EQ(near.volume, far.volume);
}

TEST(MeasureSurface, MirroringTurnsTheSignUnlessTrianglesAreTurnedToo) {
  const AffineGeometry mirrored({0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {0, 0, 1});
  ASSERT_TRUE(mirrored.mirrored());
  EXPECT_DOUBLE_EQ(measure_surface(kBox, mirrored).volume, -4);
  IndexedMesh turned = kBox;
  for (Triangle& triangle : turned.triangles) std::swap(triangle[1], triangle[2]);
  EXPECT_DOUBLE_EQ(measure_surface(turned, mirrored).volume, 4);
}

TEST(MeasureSurface, SphereApproachesTheFormulas) {
  const SurfaceMeasures sphere = measure_surface(test::sphere({50, 50, 50}, 40, 200, 400), AffineGeometry());
  EXPECT_NEAR(sphere.area, 4 * std::numbers::pi * 40 * 40, 10);
  EXPECT_NEAR(sphere.volume, 4.0 / 3 * std::numbers::pi * 40 * 40 * 40, 100);
}

TEST(MeasureSurface, CavitiesCountAgainstTheVolume) {
  IndexedMesh mesh = test::box({0, 0, 0}, {10, 10, 10});
  IndexedMesh cavity = kBox;
  for (Triangle& triangle : cavity.triangles) std::swap(triangle[1], triangle[2]);
  test::append(mesh, cavity);
  EXPECT_DOUBLE_EQ(measure_surface(mesh, AffineGeometry()).volume, 996);
}

/// A geometry that is not affine: sheared by a parabola, which keeps volumes.
class Bent final : public GridGeometry {
 public:
  Vec3d map(Vec3d p) const override { return {p.x + 1e6, p.y, p.z + p.x * p.x}; }
  const std::array<double, 16>* affine() const override { return nullptr; }
  bool mirrored() const override { return false; }
};

TEST(MeasureSurface, MapsVerticesOfCurvedGeometries) {
  EXPECT_NEAR(measure_surface(kBox, Bent()).volume, 4, 1e-8);
}

TEST(MeasureSurface, NothingHasNoAreaAndNoVolume) {
  const SurfaceMeasures nothing = measure_surface({}, AffineGeometry());
  EXPECT_EQ(nothing.area, 0);
  EXPECT_EQ(nothing.volume, 0);
}

}  // namespace
}  // namespace geosis
