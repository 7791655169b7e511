#include "engine/simplify/lanes/star_shape.h"

#include <vector>

#include <gtest/gtest.h>

#include "tests/engine/simplify/patch.h"

namespace geosis::HWY_NAMESPACE {
namespace {

//   3---2
//   | / |    in the plane z = 0, around the centre 4
//   0---1
Patch pyramid_base() {
  Patch p = make_patch(5, {{4, 0, 1}, {4, 1, 2}, {4, 2, 3}, {4, 3, 0}}, {0, 1, 2, 3});
  const Vec3f places[] = {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {1, 1, 0}};
  for (int v = 0; v < 5; ++v) p.vertices[v].position = places[v];
  return p;
}

MovedStar moved_to(Patch p, Vec3f position) {
  MergedStar star;
  EXPECT_TRUE(find_merged_star(0, 4, p.vertices, p.rings, p.marks, star));
  StarShape shape;
  measure_star(star, 0, 4, p.vertices.data(), shape);
  MovedStar moved;
  move_star(star, shape, position, false, moved);
  return moved;
}

bool sound_at(const Patch& p, Vec3f position) {
  return moved_to(p, position).sound;
}

TEST(MoveStar, AcceptsAPlaceInside) {
  EXPECT_TRUE(sound_at(pyramid_base(), {0, 0, 0}));
  EXPECT_TRUE(sound_at(pyramid_base(), {0.5f, 0.5f, 0.25f}));
}

TEST(MoveStar, RefusesTurningATriangleOver) {
  EXPECT_FALSE(sound_at(pyramid_base(), {3, 1, 0}));
}

TEST(MoveStar, RefusesZeroArea) {
  EXPECT_FALSE(sound_at(pyramid_base(), {2, 1, 0}));
}

TEST(MoveStar, RefusesThePlaceOfANeighbour) {
  EXPECT_FALSE(sound_at(pyramid_base(), {2, 2, 0}));
}

TEST(MoveStar, GivesThePlanesOfTheMovedTriangles) {
  const MovedStar moved = moved_to(pyramid_base(), {0, 0, 0});
  EXPECT_FALSE(moved.sharp);
  EXPECT_FLOAT_EQ(moved.planes.a22, 4);  // the area of the square, all of it flat
  EXPECT_FLOAT_EQ(moved.planes.trace(), 4);
}

}  // namespace
}  // namespace geosis::HWY_NAMESPACE
