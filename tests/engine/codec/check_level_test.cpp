#include "engine/codec/check_level.h"

#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "tests/support/lattice_meshes.h"

namespace geosis {
namespace {

const IndexedMesh kBox = test::box({1, 2, 3}, {4, 5, 6});

void expect_refused(const IndexedMesh& mesh, const std::string& reason, const EncodeOptions& options = {}) {
  const auto encoded = encode_level(mesh, {}, options);
  ASSERT_FALSE(encoded) << reason;
  EXPECT_EQ(encoded.error().code, ErrorCode::invalid_argument);
  EXPECT_NE(encoded.error().message.find(reason), std::string::npos) << encoded.error().message;
}

IndexedMesh box_with_position(float x) {
  IndexedMesh mesh = kBox;
  mesh.positions[5].x = x;
  return mesh;
}

IndexedMesh box_with_triangle(Triangle triangle) {
  IndexedMesh mesh = kBox;
  mesh.triangles[3] = triangle;
  return mesh;
}

TEST(CheckLevel, AcceptsABoxOnTheLattice) {
  EXPECT_TRUE(check_level(kBox, {}, {}));
}

TEST(CheckLevel, RefusesPositionsThatAreNotFinite) {
  for (const float x : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                        -std::numeric_limits<float>::infinity()}) {
    expect_refused(box_with_position(x), "vertex 5, axis 0");
  }
}

TEST(CheckLevel, RefusesPositionsOffTheLattice) {
  for (const float x : {1.0f / 128, 4 + 1.0f / 65536, 1e-30f}) expect_refused(box_with_position(x), "vertex 5, axis 0");
}

TEST(CheckLevel, RefusesPositionsOutOfRange) {
  for (const float x : {-kLatticeStep, 256.0f, 1e30f}) expect_refused(box_with_position(x), "from 0 to 255.98");
}

TEST(CheckLevel, AcceptsTheEndsOfTheRange) {
  EXPECT_TRUE(check_level(box_with_position(0), {}, {}));
  EXPECT_TRUE(check_level(box_with_position(256 - kLatticeStep), {}, {}));
}

TEST(CheckLevel, RefusesBadIndices) {
  for (const std::int32_t v : {-1, 8, std::numeric_limits<std::int32_t>::max()}) {
    expect_refused(box_with_triangle({0, v, 1}), "triangle 3: vertex " + std::to_string(v) + " of 8");
  }
}

TEST(CheckLevel, RefusesRepeatedVertices) {
  for (const Triangle triangle : {Triangle{1, 1, 2}, Triangle{2, 1, 1}, Triangle{1, 2, 1}}) {
    expect_refused(box_with_triangle(triangle), "triangle 3 uses a vertex twice");
  }
}

TEST(CheckLevel, RefusesLevelsWithoutTriangles) {
  expect_refused({}, "without triangles");
  expect_refused({{{1, 2, 3}}, {}}, "without triangles");
}

TEST(CheckLevel, RefusesOptionsOutOfRange) {
  expect_refused(kBox, "position bits 0", {.position_bits = 0});
  expect_refused(kBox, "position bits 24", {.position_bits = 24});
  expect_refused(kBox, "0 triangles a part", {.max_part_triangles = 0});
  expect_refused(kBox, "speed 11", {.speed = 11});
  expect_refused(kBox, "speed -1", {.speed = -1});
  EncodeOptions options;
  options.transform[7] = std::numeric_limits<double>::quiet_NaN();
  expect_refused(kBox, "transform", options);
}

}  // namespace
}  // namespace geosis
