#include "engine/analysis/self_intersections.h"

#include <cstddef>
#include <random>

#include <gtest/gtest.h>

#include "engine/mesh/lattice_triangles.h"

namespace geosis {
namespace {

using Pairs = std::vector<std::array<std::int32_t, 2>>;

void add_triangle(IndexedMesh& mesh, Vec3f a, Vec3f b, Vec3f c) {
  const auto first = static_cast<std::int32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), {a, b, c});
  mesh.triangles.push_back({first, first + 1, first + 2});
}

/// Triangles of all sizes up to `size` voxels, in a box of 20 voxels around the origin.
IndexedMesh triangle_soup(int triangles, int size, unsigned seed) {
  std::mt19937 random(seed);
  const auto steps = [&](int range) {
    return static_cast<float>(random() % static_cast<unsigned>(range)) * kLatticeStep;
  };
  IndexedMesh mesh;
  for (int n = 0; n < triangles; ++n) {
    const Vec3f at{steps(1280) - 10, steps(1280) - 10, steps(1280) - 10};
    const auto near = [&] { return at + Vec3f{steps(64 * size), steps(64 * size), steps(64 * size)}; };
    const Vec3f a = near(), b = near(), c = near();
    add_triangle(mesh, a, b, c);
  }
  return mesh;
}

LatticePoint steps_of(Vec3f p) {
  return {static_cast<std::int64_t>(p.x * 64), static_cast<std::int64_t>(p.y * 64),
          static_cast<std::int64_t>(p.z * 64)};
}

Pairs pairs_by_brute_force(const IndexedMesh& mesh) {
  Pairs pairs;
  const auto corners = [&](std::size_t t) -> LatticeTriangle {
    const auto& [a, b, c] = mesh.triangles[t];
    return {steps_of(mesh.positions[a]), steps_of(mesh.positions[b]), steps_of(mesh.positions[c])};
  };
  for (std::size_t a = 0; a < mesh.triangles.size(); ++a) {
    for (std::size_t b = a + 1; b < mesh.triangles.size(); ++b) {
      if (triangles_intersect(corners(a), corners(b)))
        pairs.push_back({static_cast<std::int32_t>(a), static_cast<std::int32_t>(b)});
    }
  }
  return pairs;
}

TEST(SelfIntersections, NoTriangleIsNone) {
  EXPECT_EQ(count_intersecting_pairs({}, 1), 0);
}

TEST(SelfIntersections, CrossingTrianglesAreAPair) {
  IndexedMesh mesh;
  add_triangle(mesh, {0, 0, 0}, {4, 0, 0}, {0, 4, 0});
  add_triangle(mesh, {9, 9, 9}, {9, 8, 9}, {8, 9, 9});
  add_triangle(mesh, {1, 1, -1}, {1, 1, 1}, {3, 3, 2});
  EXPECT_EQ(find_intersecting_pairs(mesh, 1), (Pairs{{0, 2}}));
}

TEST(SelfIntersections, CopiesOfAVertexTouchWithoutIntersecting) {
  IndexedMesh mesh;
  add_triangle(mesh, {0, 0, 0}, {4, 0, 0}, {0, 4, 0});
  add_triangle(mesh, {0, 0, 0}, {-4, 0, 1}, {0, -4, 1});
  EXPECT_EQ(count_intersecting_pairs(mesh, 1), 0);
}

TEST(SelfIntersections, GridFindsEveryPairOnceForAnyNumberOfThreads) {
  for (const int size : {1, 3, 15}) {
    const IndexedMesh mesh = triangle_soup(600, size, 7);
    const Pairs expected = pairs_by_brute_force(mesh);
    ASSERT_FALSE(expected.empty());
    for (const int threads : {1, 3}) {
      EXPECT_EQ(find_intersecting_pairs(mesh, threads), expected) << size << " voxels, " << threads << " threads";
      EXPECT_EQ(count_intersecting_pairs(mesh, threads), static_cast<std::int64_t>(expected.size()));
    }
  }
}

TEST(SelfIntersections, OneHugeTriangleAmongManySmallOnesIsNoTrouble) {
  IndexedMesh mesh = triangle_soup(4'000, 1, 11);
  add_triangle(mesh, {-100'000, -99'000, -98'000}, {100'000, 98'000, 97'000}, {-99'000, 98'000, -1'000});
  const Pairs pairs = find_intersecting_pairs(mesh, 2);
  EXPECT_FALSE(pairs.empty());
}

}  // namespace
}  // namespace geosis
