#include "engine/codec/join_parts.h"

#include <limits>
#include <string>

#include <gtest/gtest.h>

namespace geosis {
namespace {

/// Two triangles of a square that share the edge with the seam ids 1 and 2.
std::vector<MeshPart> square_in_two_parts() {
  return {{{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}}, {{0, 1, 2}}}, {1, 0, 2}},
          {{{{1, 1, 0}, {0, 1, 0}, {0, 0, 0}}, {{0, 1, 2}}}, {2, 0, 1}}};
}

void expect_refused(std::vector<MeshPart> parts, const std::string& reason) {
  const auto joined = join_parts(std::move(parts));
  ASSERT_FALSE(joined) << reason;
  EXPECT_EQ(joined.error().code, ErrorCode::malformed_input);
  EXPECT_NE(joined.error().message.find(reason), std::string::npos) << joined.error().message;
}

TEST(JoinParts, VerticesWithOneSeamIdBecomeOne) {
  const auto joined = join_parts(square_in_two_parts());
  ASSERT_TRUE(joined) << joined.error().message;
  EXPECT_EQ(joined->mesh.positions, (std::vector<Vec3f>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}));
  EXPECT_EQ(joined->mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {2, 3, 0}}));
}

TEST(JoinParts, EqualPositionsWithoutSeamIdStayApart) {
  auto parts = square_in_two_parts();
  for (MeshPart& part : parts) part.seams.clear();
  EXPECT_EQ(join_parts(parts)->mesh.positions.size(), 6u);
}

TEST(JoinParts, RefusesPartsThatDisagreeOnAPosition) {
  auto parts = square_in_two_parts();
  parts[1].mesh.positions[0].x += kLatticeStep;
  expect_refused(parts, "disagree on the position of seam vertex 2");
}

TEST(JoinParts, ComparesPositionsBitForBit) {
  auto parts = square_in_two_parts();
  parts[1].mesh.positions[2].z = -0.0f;
  expect_refused(parts, "disagree on the position of seam vertex 1");
}

TEST(JoinParts, RefusesASeamIdThatOnlyOnePartHas) {
  auto parts = square_in_two_parts();
  parts[0].seams[1] = 3;
  expect_refused(parts, "seam vertex 3 is in part 0 only");
}

TEST(JoinParts, RefusesASeamIdBeyondTheNumberOfVertices) {
  auto parts = square_in_two_parts();
  parts[1].seams[1] = std::numeric_limits<std::uint32_t>::max();
  expect_refused(parts, "seam vertex 4294967295 of 6");
}

TEST(JoinParts, RefusesASeamThatCollapsesATriangle) {
  auto parts = square_in_two_parts();
  parts[1].mesh.positions[2] = parts[1].mesh.positions[0];
  parts[1].seams[2] = 2;
  expect_refused(parts, "part 1: the seam collapses a triangle");
}

}  // namespace
}  // namespace geosis
