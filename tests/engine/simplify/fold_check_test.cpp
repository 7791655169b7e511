#include "engine/simplify/lanes/fold_check.h"

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/engine/simplify/field_mesh.h"
#include "tests/support/random.h"

namespace geosis::HWY_NAMESPACE {
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
  /// Whether 0 and 1 may merge at all, and fold then.
  bool merges_at(Vec3f position, bool& folds) {
    MergedStar star;
    if (!find_merged_star(0, 1, vertices, rings, marks, star)) return false;
    StarShape shape;
    measure_star(star, 0, 1, vertices.data(), shape);
    const bool closed = !vertices[0].on_boundary && !vertices[1].on_boundary;
    MovedStar moved;
    move_star(star, shape, position, closed, moved);
    folds = folds_over(star, shape, moved, 0, 1, position, closed, vertices.data(), rings, marks);
    return true;
  }
  bool folds_at(Vec3f position) {
    bool folds = false;
    EXPECT_TRUE(merges_at(position, folds));
    return folds;
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

TEST(FoldsOver, WhenATriangleNextToTheStarIsHit) {
  // A flap on the edge 4-3 that bends back over the star.
  const std::vector<Vec3f> tip = {{0, -1, 1}};
  const std::vector<LocalTriangle> flap = {{3, 8, 4}};
  EXPECT_FALSE(hexagons(tip, flap).folds_at({1, 0, 0}));
  EXPECT_TRUE(hexagons(tip, flap).folds_at({0, 0, 2}));
  EXPECT_FALSE(hexagons(tip, flap).folds_at({0, 0, -2}));
}

/// Every pair of the star's triangles, and of those with the triangles that share a vertex with them, by itself.
bool any_pair_meets(const Patch& p, LocalVertex u, LocalVertex v, const MergedStar& star, Vec3f position) {
  const auto at = [&](LocalVertex w) {
    const Vec3f place = (w == u || w == v) ? position : p.vertices[w].position;
    return LatticePoint{std::int64_t(place.x * 64), std::int64_t(place.y * 64), std::int64_t(place.z * 64)};
  };
  std::vector<LatticeTriangle> in_star, around;
  for (const auto [a, b] : star.triangles()) in_star.push_back({at(u), at(a), at(b)});
  for (const RingTriangle t : star.triangles()) {
    for (const LocalVertex w : {t.a, t.b}) {
      for (const auto [a, b] : p.rings.of(w)) {
        if (a != u && b != u && a != v && b != v) around.push_back({at(w), at(a), at(b)});
      }
    }
  }
  for (std::size_t i = 0; i < in_star.size(); ++i) {
    for (std::size_t k = i + 1; k < in_star.size(); ++k) {
      if (triangles_intersect(in_star[i], in_star[k])) return true;
    }
    for (const LatticeTriangle& t : around) {
      if (triangles_intersect(in_star[i], t)) return true;
    }
  }
  return false;
}

/// Random places for the merged vertices of random edges of rough surfaces, near and far, also on others' planes.
void compare_with_every_pair(const IndexedMesh& mesh, test::Random& random, float scale, int& folds, int& others) {
  std::vector<LocalTriangle> triangles;
  for (const auto& [a, b, c] : mesh.triangles) {
    triangles.push_back({static_cast<LocalVertex>(a), static_cast<LocalVertex>(b), static_cast<LocalVertex>(c)});
  }
  std::vector<Vec3f> positions;
  for (const Vec3f p : mesh.positions) positions.push_back(p * scale);
  Patch patch(positions, triangles);
  for (int i = 0; i < 2500; ++i) {
    const auto u = triangles[random.integer(0, static_cast<int>(triangles.size()) - 1)][0];
    const auto ring = patch.rings.of(u);
    const LocalVertex v = ring[random.integer(0, static_cast<int>(ring.size()) - 1)].a;
    MergedStar star;
    if (!find_merged_star(u, v, patch.vertices, patch.rings, patch.marks, star)) continue;
    const float reach = scale * (i % 3 == 0 ? 0.25f : i % 3 == 1 ? 1.0f : 4.0f);
    Vec3f position = positions[u];
    for (int axis = 0; axis < 3; ++axis) {
      if (random.integer(0, 2) > 0) position[axis] += std::round(random.between(-reach, reach) * 64) / 64;
    }
    StarShape shape;
    measure_star(star, u, v, patch.vertices.data(), shape);
    MovedStar moved;
    move_star(star, shape, position, true, moved);
    if (!moved.sound) continue;  // is refused for that, and has no normals
    const bool expected = any_pair_meets(patch, u, v, star, position);
    EXPECT_EQ(folds_over(star, shape, moved, u, v, position, true, patch.vertices.data(), patch.rings, patch.marks),
              expected);
    ++(expected ? folds : others);
  }
}

TEST(FoldsOver, AgreesWithEveryPairOfTriangles) {
  const std::uint64_t seed = test::test_seed(20261126);
  test::Random random(seed);
  SCOPED_TRACE("GEOSIS_SEED=" + std::to_string(seed));
  const std::array<int, 3> shape{9, 9, 9};
  int folds = 0, others = 0;
  for (int i = 0; i < 30; ++i) {
    const IndexedMesh mesh = mesh_field(shape, closed_on_faces(shape, noise(random.bits())));
    compare_with_every_pair(mesh, random, i % 3 == 2 ? 32.0f : 1.0f, folds, others);  // some beyond float32's reach
  }
  EXPECT_GT(folds, 100);
  EXPECT_GT(others, 100);
}

}  // namespace
}  // namespace geosis::HWY_NAMESPACE
