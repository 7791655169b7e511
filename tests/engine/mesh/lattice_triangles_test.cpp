#include "engine/mesh/lattice_triangles.h"

#include <algorithm>
#include <array>

#include <gtest/gtest.h>

namespace geosis {
namespace {

// Both orders of the triangles, all orders of their corners, near the origin and far apart: one answer.
void expect_intersect(LatticeTriangle s, LatticeTriangle t, bool expected) {
  constexpr std::array<std::array<int, 3>, 6> kOrders = {
      {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}}};
  for (const std::int64_t scale : {1, 1000, 1'000'000}) {
    for (const auto& m : kOrders) {
      for (const auto& n : kOrders) {
        const LatticeTriangle p = {s[m[0]] * scale, s[m[1]] * scale, s[m[2]] * scale};
        const LatticeTriangle q = {t[n[0]] * scale, t[n[1]] * scale, t[n[2]] * scale};
        ASSERT_EQ(triangles_intersect(p, q), expected) << "scale " << scale;
        ASSERT_EQ(triangles_intersect(q, p), expected) << "scale " << scale;
      }
    }
  }
}

constexpr LatticeTriangle kFlat = {{{0, 0, 0}, {6, 0, 0}, {0, 6, 0}}};

TEST(LatticeTriangles, OneThatPiercesTheOtherIntersects) {
  expect_intersect(kFlat, {{{1, 1, -2}, {1, 1, 3}, {9, 9, 1}}}, true);
}

TEST(LatticeTriangles, OneBesideTheOtherDoesNot) {
  expect_intersect(kFlat, {{{5, 5, -2}, {5, 5, 3}, {9, 9, 1}}}, false);
  expect_intersect(kFlat, {{{1, 1, 1}, {1, 1, 3}, {9, 9, 1}}}, false);
}

TEST(LatticeTriangles, TouchingWithoutACommonCornerIntersects) {
  expect_intersect(kFlat, {{{1, 1, 0}, {1, 1, 3}, {2, 3, 4}}}, true);    // corner in the middle
  expect_intersect(kFlat, {{{3, 3, 0}, {9, 3, 3}, {9, 4, 4}}}, true);    // corner on a side
  expect_intersect(kFlat, {{{6, -1, 1}, {6, 1, -1}, {9, 0, 0}}}, true);  // corner of the other on a side
}

TEST(LatticeTriangles, InOnePlaneOverlapCounts) {
  expect_intersect(kFlat, {{{1, 1, 0}, {2, 1, 0}, {1, 2, 0}}}, true);   // one inside the other
  expect_intersect(kFlat, {{{-1, 2, 0}, {9, 2, 0}, {9, 3, 0}}}, true);  // sides cross
  expect_intersect(kFlat, {{{4, 3, 0}, {9, 3, 0}, {9, 9, 0}}}, false);
  expect_intersect(kFlat, {{{6, 1, 0}, {1, 6, 0}, {9, 9, 0}}}, false);
}

TEST(LatticeTriangles, ACommonCornerAloneIsNoIntersection) {
  expect_intersect(kFlat, {{{0, 0, 0}, {-3, 1, 2}, {-3, 2, 5}}}, false);
  expect_intersect(kFlat, {{{0, 0, 0}, {1, 1, 3}, {2, 1, 3}}}, false);
  expect_intersect(kFlat, {{{0, 0, 0}, {-6, 0, 0}, {0, -6, 0}}}, false);
}

TEST(LatticeTriangles, ACommonCornerAndMoreIs) {
  expect_intersect(kFlat, {{{0, 0, 0}, {2, 1, 3}, {2, 1, -3}}}, true);  // passes through
  expect_intersect(kFlat, {{{0, 0, 0}, {3, 0, 0}, {0, 0, 5}}}, true);   // side along a side
  expect_intersect(kFlat, {{{0, 0, 0}, {1, 2, 0}, {2, 1, 0}}}, true);   // in the same plane
  expect_intersect(kFlat, {{{0, 0, 0}, {8, 9, 0}, {9, 8, 0}}}, true);
}

TEST(LatticeTriangles, ACommonSideIsAnIntersectionOnlyWhenFoldedFlat) {
  expect_intersect(kFlat, {{{0, 0, 0}, {6, 0, 0}, {1, 1, 1}}}, false);
  expect_intersect(kFlat, {{{0, 0, 0}, {6, 0, 0}, {1, -1, 0}}}, false);
  expect_intersect(kFlat, {{{0, 0, 0}, {6, 0, 0}, {1, 1, 0}}}, true);
  expect_intersect(kFlat, {{{0, 0, 0}, {6, 0, 0}, {9, 9, 0}}}, true);
}

TEST(LatticeTriangles, TheSameTriangleTwiceIntersects) {
  expect_intersect(kFlat, kFlat, true);
}

TEST(LatticeTriangles, TrianglesWithoutAreaMeetNothing) {
  expect_intersect(kFlat, {{{1, 1, -2}, {1, 1, 3}, {1, 1, 5}}}, false);
  expect_intersect(kFlat, {{{1, 1, 0}, {1, 1, 0}, {1, 1, 0}}}, false);
}

TEST(LatticeTriangles, NearMissesOfHugeTrianglesAreDecidedExactly) {
  constexpr std::int64_t kFar = (std::int64_t{1} << 24) - 1;
  const LatticeTriangle slope = {{{-kFar, -kFar, -kFar}, {kFar, -kFar, 1 - kFar}, {-kFar, kFar, kFar}}};
  // On the plane of `slope` at x = y = 0 lies z = 1/2: these end on either side of it.
  EXPECT_FALSE(triangles_intersect(slope, {{{-1, -1, kFar}, {-2, -1, kFar}, {-1, -1, 0}}}));
  EXPECT_TRUE(triangles_intersect(slope, {{{-1, -1, kFar}, {-2, -1, kFar}, {-1, -1, -1}}}));
}

}  // namespace
}  // namespace geosis
