#include "engine/simplify/merged_star.h"

#include <vector>

#include <gtest/gtest.h>

#include "tests/engine/simplify/patch.h"

namespace geosis {
namespace {

bool may_merge(Patch p, LocalVertex u, LocalVertex v) {
  MergedStar star;
  return find_merged_star(u, v, p.vertices, p.rings, p.marks, star);
}

//     3---4---5
//    / . / . / .
//   2---0---7---6      two inner vertices, 0 and 7 (dots stand for the other diagonals)
//    . / . / . /
//     1---9---8
Patch two_inner_vertices() {
  return make_patch(
      10,
      {{0, 3, 2}, {0, 4, 3}, {0, 7, 4}, {0, 9, 7}, {0, 1, 9}, {0, 2, 1}, {7, 5, 4}, {7, 6, 5}, {7, 8, 6}, {7, 9, 8}},
      {1, 2, 3, 4, 5, 6, 8, 9});
}

TEST(MergedStar, InnerEdgeMayMerge) {
  Patch p = two_inner_vertices();
  MergedStar star;
  ASSERT_TRUE(find_merged_star(0, 7, p.vertices, p.rings, p.marks, star));
  EXPECT_EQ(star.shared, 2);
  EXPECT_EQ(star.from_u, 4);
  EXPECT_EQ(star.degree, 8);
}

TEST(MergedStar, BoundaryEdgeMayMerge) {
  EXPECT_TRUE(may_merge(two_inner_vertices(), 2, 3));
}

TEST(MergedStar, InnerEdgeBetweenBoundaryVerticesMayNot) {
  //   3---2
  //   | / |
  //   0---1
  EXPECT_FALSE(may_merge(make_patch(4, {{0, 1, 2}, {0, 2, 3}}, {0, 1, 2, 3}), 0, 2));
  EXPECT_TRUE(may_merge(make_patch(4, {{0, 1, 2}, {0, 2, 3}}, {0, 1, 2, 3}), 0, 1));
}

TEST(MergedStar, SingleTriangleStays) {
  EXPECT_FALSE(may_merge(make_patch(3, {{0, 1, 2}}, {0, 1, 2}), 0, 1));
}

TEST(MergedStar, TetrahedronStays) {
  EXPECT_FALSE(may_merge(make_patch(4, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}, {}), 0, 1));
}

TEST(MergedStar, TwoTrianglesBackToBackStay) {
  EXPECT_FALSE(may_merge(make_patch(3, {{0, 1, 2}, {0, 2, 1}}, {}), 0, 1));
}

TEST(MergedStar, ThreeEdgeHoleStays) {
  // An annulus around the hole 0 1 2 with the outer ring 3 4 5.
  const std::vector<LocalTriangle> annulus = {{0, 3, 4}, {0, 4, 1}, {1, 4, 5}, {1, 5, 2}, {2, 5, 3}, {2, 3, 0}};
  EXPECT_FALSE(may_merge(make_patch(6, annulus, {0, 1, 2, 3, 4, 5}), 0, 1));
}

TEST(MergedStar, WaistOfThreeEdgesStays) {
  // Two tetrahedra-like caps (apexes 3 and 4) on the triangle 0 1 2: merging 0 and 1 would leave two triangles on 2.
  const std::vector<LocalTriangle> bipyramid = {{0, 1, 3}, {1, 2, 3}, {2, 0, 3}, {1, 0, 4}, {2, 1, 4}, {0, 2, 4}};
  EXPECT_FALSE(may_merge(make_patch(5, bipyramid, {}), 0, 1));
  EXPECT_TRUE(may_merge(make_patch(5, bipyramid, {}), 0, 3));
}

TEST(MergedStar, VerticesOfOtherTrianglesOnlyDoNotMerge) {
  EXPECT_FALSE(may_merge(two_inner_vertices(), 2, 6));
}

TEST(SnapToLattice, RoundsToTheNearestStepInsideTheBox) {
  const Box box{{-1, -1, -1}, {100, 100, 100}};
  EXPECT_EQ(snap_to_lattice({0.3f, -0.3f, 99.9999f}, box), (Vec3f{19.0f / 64, -19.0f / 64, 100}));
  EXPECT_EQ(snap_to_lattice({-7, 250, 4}, box), (Vec3f{-1, 100, 4}));
}

TEST(VertexMarks, SurviveMoreClearsThanTheirCounterHolds) {
  VertexMarks marks;
  marks.reset(2);
  for (int i = 0; i < 70'000; ++i) {
    marks.clear();
    ASSERT_FALSE(marks.has(0)) << i;
    marks.set(0);
    ASSERT_TRUE(marks.has(0));
    ASSERT_FALSE(marks.has(1)) << i;
  }
}

}  // namespace
}  // namespace geosis
