#include "engine/simplify/fold_check.h"

#include <vector>

#include <gtest/gtest.h>

namespace geosis {
namespace {

/// The star of 0 and 1, which merge, with triangles around it.
struct Patch {
  std::vector<WorkingVertex> vertices;
  Rings rings;
  VertexMarks marks;

  Patch(const std::vector<Vec3f>& positions, const std::vector<LocalTriangle>& triangles) {
    for (const Vec3f p : positions) vertices.push_back(make_vertex(p, 0));
    rings.build(vertices.size(), triangles);
    marks.reset(vertices.size());
  }
  bool folds_at(Vec3f position) {
    MergedStar star;
    EXPECT_TRUE(find_merged_star(0, 1, vertices, rings, marks, star));
    StarShape shape;
    measure_star(star, 0, 1, vertices, shape);
    return folds_over(star, shape, 0, 1, position, vertices, rings, marks);
  }
};

//      4---3
//     / \ / \        in the plane z = 0, around the edge 0-1;
//    5---0---1---2   7 and 6 below, 4 and 3 above
//     \ / \ /
//      6---7
Patch hexagons(std::vector<Vec3f> more = {}, std::vector<LocalTriangle> more_triangles = {}) {
  std::vector<Vec3f> positions = {{0, 0, 0},  {2, 0, 0},  {4, 0, 0},   {1, 2, 0},
                                  {-1, 2, 0}, {-2, 0, 0}, {-1, -2, 0}, {1, -2, 0}};
  std::vector<LocalTriangle> triangles = {{0, 1, 3}, {0, 3, 4}, {0, 4, 5}, {0, 5, 6},
                                          {0, 6, 7}, {0, 7, 1}, {1, 2, 3}, {1, 7, 2}};
  positions.insert(positions.end(), more.begin(), more.end());
  triangles.insert(triangles.end(), more_triangles.begin(), more_triangles.end());
  return Patch(positions, triangles);
}

TEST(FoldsOver, NotInsideAFlatStar) {
  EXPECT_FALSE(hexagons().folds_at({1, 0, 0}));
  EXPECT_FALSE(hexagons().folds_at({1, 0, 3}));
}

TEST(FoldsOver, WhenTheVertexLeavesAFlatStar) {
  EXPECT_TRUE(hexagons().folds_at({6, 0, 0}));
}

TEST(FoldsOver, WhenATriangleNextToTheStarIsHit) {
  // A flap on the edge 4-3 that bends back over the star.
  const std::vector<Vec3f> tip = {{0, -1, 1}};
  const std::vector<LocalTriangle> flap = {{3, 8, 4}};
  EXPECT_FALSE(hexagons(tip, flap).folds_at({1, 0, 0}));
  EXPECT_TRUE(hexagons(tip, flap).folds_at({0, 0, 2}));
  EXPECT_FALSE(hexagons(tip, flap).folds_at({0, 0, -2}));
}

}  // namespace
}  // namespace geosis
