#include "engine/isosurface/cell_decisions.h"

#include <gtest/gtest.h>

#include "engine/isosurface/cell.h"

namespace geosis {
namespace {

/// A cell whose face k = 0 has the values a b c d around it (corners 0 4 6 2), and `top` above.
CellValues cell_with_bottom(double a, double b, double c, double d, double top, bool ties_above) {
  CellValues cell;
  cell.value = {a, top, d, top, b, top, c, top};
  cell.ties_above = ties_above;
  return cell;
}

constexpr int kBottom = 4;  // axis k, side 0
constexpr std::uint8_t kDiagonalAbove = 1 << 0 | 1 << 6;

TEST(AboveJoinedOnFace, FollowsTheSaddlesSide) {
  EXPECT_TRUE(above_joined_on_face(cell_with_bottom(3, -1, 3, -1, -5, true), kDiagonalAbove, kBottom));
  EXPECT_FALSE(above_joined_on_face(cell_with_bottom(1, -3, 1, -3, -5, true), kDiagonalAbove, kBottom));
}

TEST(AboveJoinedOnFace, JoinsTheClosedBodyAtATie) {
  EXPECT_TRUE(above_joined_on_face(cell_with_bottom(2, -2, 2, -2, -5, true), kDiagonalAbove, kBottom));
  EXPECT_FALSE(above_joined_on_face(cell_with_bottom(2, -2, 2, -2, -5, false), kDiagonalAbove, kBottom));
}

TEST(AboveJoinedOnFace, DecidesWhereDoubleProductsRoundToATie) {
  const double x = 1 + 0x1p-30, y = 1 - 0x1p-30;  // x y = 1 - 2^-60: rounds to 1
  EXPECT_FALSE(above_joined_on_face(cell_with_bottom(x, -1, y, -1, -5, true), kDiagonalAbove, kBottom));
  EXPECT_TRUE(above_joined_on_face(cell_with_bottom(1, -x, 1, -y, -5, false), kDiagonalAbove, kBottom));
}

TEST(AboveJoinedOnFace, DecidesLevelsFarFromTheSamples) {
  CellValues cell = cell_with_bottom(1e-30, -1e30, 1e30, 0, -1e30, true);
  cell.level = 1e-35;
  // (1e-30 - 1e-35)(1e30 - 1e-35) > 0 > (-1e30 - 1e-35)(0 - 1e-35) is false: the right side is about 1e-5, the left 1.
  EXPECT_TRUE(above_joined_on_face(cell, kDiagonalAbove, kBottom));
}

TEST(AboveJoinedOnFace, IsTheSameFromBothCells) {
  // The face k = 1 of the lower cell is k = 0 of the upper one.
  const CellValues upper = cell_with_bottom(0.3, -0.7, 0.9, -0.4, -1, true);
  CellValues lower;
  for (int c = 0; c < 8; ++c) lower.value[c] = c & 1 ? upper.value[c - 1] : 0.1 * c - 1;
  const std::uint8_t above_lower = kDiagonalAbove << 1;
  EXPECT_EQ(above_joined_on_face(upper, kDiagonalAbove, kBottom), above_joined_on_face(lower, above_lower, 5));
}

TEST(InteriorJoint, JoinsOppositeCornersThroughTheMiddle) {
  CellValues cell;
  cell.value.fill(-0.1);
  cell.value[0] = cell.value[7] = 2;  // case 4: the two high corners bulge towards each other
  const InteriorJoint joint = interior_joint(cell, 1 << 0 | 1 << 7);
  ASSERT_TRUE(joint.joined);
  EXPECT_TRUE(joint.above);
  EXPECT_EQ(joint.first + joint.second, 7);
}

TEST(InteriorJoint, LeavesFarCornersApart) {
  CellValues cell;
  cell.value.fill(-2);
  cell.value[0] = cell.value[7] = 0.1;
  EXPECT_FALSE(interior_joint(cell, 1 << 0 | 1 << 7).joined);
}

TEST(InteriorJoint, TouchingSaddleBelongsToTheClosedBody) {
  // f = h everywhere but at two opposite corners: A C - B D has a double root where 1 = -h exactly (value 1 at 0 and
  // 7).
  CellValues cell;
  cell.value.fill(-1.0 / 3);
  cell.value[0] = cell.value[7] = 1;
  for (double& v : cell.value) v *= 3;  // 3 and -1: the body saddle lies exactly on 0
  cell.ties_above = true;
  EXPECT_TRUE(interior_joint(cell, 1 << 0 | 1 << 7).joined);
  cell.ties_above = false;
  EXPECT_FALSE(interior_joint(cell, 1 << 0 | 1 << 7).joined);
}

}  // namespace
}  // namespace geosis
