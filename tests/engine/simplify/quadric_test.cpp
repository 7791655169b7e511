#include "engine/simplify/quadric.h"

#include <gtest/gtest.h>

namespace geosis {
namespace {

Quadric some_quadric() {
  Quadric q;
  add_plane(q, {1, 2, -1}, 0.5f);
  add_plane(q, {0, 1, 3}, 2.0f);
  return q;
}

TEST(Quadric, IsZeroOnThePlane) {
  Quadric q;
  add_plane(q, {0, 0, 2}, 1.0f);
  EXPECT_EQ(q.value({5, -3, 0}), 0);
  EXPECT_EQ(q.value({5, -3, 1.5f}), 9);
}

TEST(Quadric, KeepsItsValueInAnotherFrame) {
  const Quadric q = some_quadric();
  const Vec3f origin{3, -2, 0.5f};
  const Quadric moved = seen_from(q, origin);
  for (const Vec3f p : {Vec3f{0, 0, 0}, Vec3f{1, 2, 3}, Vec3f{-4, 0.25f, 1}}) {
    EXPECT_FLOAT_EQ(moved.value(p + origin), q.value(p));
  }
}

TEST(Quadric, SumsValues) {
  const Quadric p = some_quadric();
  const Quadric q = seen_from(p, {1, 1, 1});
  EXPECT_FLOAT_EQ((p + q).value({2, 0, 1}), p.value({2, 0, 1}) + q.value({2, 0, 1}));
}

TEST(Quadric, BlendKeepsTheErrorWhole) {
  Quadric p = some_quadric();
  p.c = 7;
  const Quadric blended = blend(p, Quadric{}, 0.5f);
  EXPECT_EQ(blended.c, 7);
  EXPECT_EQ(blended.trace(), p.trace() / 2);
}

}  // namespace
}  // namespace geosis
