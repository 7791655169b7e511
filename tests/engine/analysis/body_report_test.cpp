#include "engine/analysis/body_report.h"

#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/lattice_meshes.h"

namespace geosis {
namespace {

IndexedMesh turned(IndexedMesh mesh) {
  for (Triangle& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
  return mesh;
}

/// Bodies of several surfaces in one mesh.
struct Labelled {
  IndexedMesh mesh;
  std::vector<std::uint32_t> body;

  void add(std::uint32_t number, const IndexedMesh& surface) {
    test::append(mesh, surface);
    body.resize(mesh.positions.size(), number);
  }
};

/// Body 0: a box with a cavity; body 1: a box inside that cavity.
Labelled nested() {
  Labelled nest;
  nest.add(0, test::box({0, 0, 0}, {10, 10, 10}));
  nest.add(1, test::box({4, 4, 4}, {5, 6, 7}));
  nest.add(0, turned(test::box({2, 2, 2}, {8, 8, 8})));
  return nest;
}

std::vector<BodyReport> report(const Labelled& labelled, std::size_t bodies, const GridGeometry& geometry) {
  auto reports = report_bodies(labelled.mesh, labelled.body, bodies, geometry);
  EXPECT_TRUE(reports) << reports.error().message;
  return reports ? std::move(reports).value() : std::vector<BodyReport>(bodies);
}

void expect_near(Vec3d found, Vec3d expected) {
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(found[axis], expected[axis], 1e-9) << axis;
}

TEST(ReportBodies, CavitiesBelongToTheirBodyAndWhatLiesInsideDoesNot) {
  const auto bodies = report(nested(), 2, AffineGeometry());
  EXPECT_EQ(bodies[0].components, 2);
  EXPECT_EQ(bodies[0].cavities, 1);
  EXPECT_DOUBLE_EQ(bodies[0].volume, 1000 - 216);
  EXPECT_EQ(bodies[0].volume_voxels, 1000 - 216);
  EXPECT_DOUBLE_EQ(bodies[0].area, 600 + 216);
  EXPECT_EQ(bodies[1].components, 1);
  EXPECT_EQ(bodies[1].cavities, 0);
  EXPECT_EQ(bodies[1].volume_voxels, 6);
}

TEST(ReportBodies, CentroidAndBoxAreThoseOfTheSolid) {
  Labelled labelled;
  labelled.add(0, test::box({0, 0, 0}, {8, 4, 4}));
  labelled.add(0, turned(test::box({1, 1, 1}, {3, 3, 3})));  // 8 of 128, at (2, 2, 2)
  const auto bodies = report(labelled, 1, AffineGeometry({100, 200, 300}, {2, 0, 0}, {0, 3, 0}, {0, 0, 5}));
  expect_near(bodies[0].centroid, {100 + 2 * (128 * 4 - 8 * 2) / 120.0, 206, 310});
  expect_near(bodies[0].low, {100, 200, 300});
  expect_near(bodies[0].high, {116, 212, 320});
}

TEST(ReportBodies, NeitherAFarOriginNorAFarBodyCostsDigits) {
  Labelled near, far;
  near.add(0, test::box({0, 0, 0}, {1, 1, 2}));
  far.add(0, test::box({0, 0, 0}, {9, 9, 9}));
  far.add(1, test::box({90'000, 80'000, 70'000}, {90'001, 80'001, 70'002}));
  const Vec3d i = {17.1, 3.3, 0}, j = {-2.9, 11.7, 0}, k = {0, 0, 4};
  const auto expected = report(near, 1, AffineGeometry({0, 0, 0}, i, j, k));
  const auto found = report(far, 2, AffineGeometry({654'321.7, 6'543'210.3, -12'345.6}, i, j, k));
  EXPECT_EQ(found[1].volume, expected[0].volume);
  EXPECT_EQ(found[1].area, expected[0].area);
  EXPECT_EQ(found[1].volume_voxels, 2);
}

TEST(ReportBodies, GenusIsThatOfTheSurfaces) {
  Labelled labelled;
  labelled.add(0, test::torus({50, 50, 50}, 20, 6, 40, 20));
  labelled.add(1, test::sphere({10, 10, 10}, 5, 10, 20));
  const auto bodies = report(labelled, 2, AffineGeometry());
  EXPECT_EQ(bodies[0].genus, 1);
  EXPECT_EQ(bodies[1].genus, 0);
}

TEST(ReportBodies, AMirroringGeometryKeepsSigns) {
  Labelled labelled = nested();
  labelled.mesh = turned(labelled.mesh);
  const auto bodies = report(labelled, 2, AffineGeometry({0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {0, 0, 1}));
  EXPECT_EQ(bodies[0].volume_voxels, 784);
  EXPECT_DOUBLE_EQ(bodies[0].volume, 784);
  EXPECT_EQ(bodies[0].cavities, 1);
}

TEST(ReportBodies, SurfacesWithoutVolumeHaveTheCentroidOfTheirVertices) {
  Labelled labelled;
  labelled.mesh = {{{0, 0, 0}, {4, 0, 0}, {4, 2, 0}, {0, 2, 0}}, {{0, 1, 2}, {0, 2, 3}}};
  labelled.body.assign(4, 0);
  const auto bodies = report(labelled, 2, AffineGeometry());
  expect_near(bodies[0].centroid, {2, 1, 0});
  EXPECT_EQ(bodies[0].cavities, 0);
  EXPECT_EQ(bodies[1].vertices, 0);
  EXPECT_EQ(bodies[1].area, 0);
}

TEST(ReportBodies, ShareOfVerticesThatAreNotMeasured) {
  const Labelled labelled = nested();
  std::vector<std::uint8_t> reliability(labelled.body.size(), 255);
  reliability[0] = 254;
  reliability[1] = 0;
  const auto bodies = report_bodies(labelled.mesh, labelled.body, 2, AffineGeometry(), reliability);
  ASSERT_TRUE(bodies);
  EXPECT_DOUBLE_EQ((*bodies)[0].interpolated_share, 2.0 / static_cast<double>((*bodies)[0].vertices));
  EXPECT_EQ((*bodies)[1].interpolated_share, 0);
}

TEST(ReportBodies, RefusesLabelsThatDoNotFit) {
  const Labelled labelled = nested();
  const auto code = [&](const std::vector<std::uint32_t>& body, std::size_t bodies,
                        const std::vector<std::uint8_t>& reliability) {
    const auto reports = report_bodies(labelled.mesh, body, bodies, AffineGeometry(), reliability);
    return reports ? ErrorCode::internal : reports.error().code;
  };
  std::vector<std::uint32_t> mixed = labelled.body;
  mixed[0] = 1;
  EXPECT_EQ(code(labelled.body, 1, {}), ErrorCode::invalid_argument);
  EXPECT_EQ(code({0, 1}, 2, {}), ErrorCode::invalid_argument);
  EXPECT_EQ(code(mixed, 2, {}), ErrorCode::invalid_argument);
  EXPECT_EQ(code(labelled.body, 2, {255}), ErrorCode::invalid_argument);
}

}  // namespace
}  // namespace geosis
