#include "engine/analysis/triangle_grid.h"

#include <algorithm>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "engine/analysis/triangle_distance.h"
#include "tests/support/lattice_meshes.h"

namespace geosis {
namespace {

double nearest_of_all(const IndexedMesh& mesh, Vec3d point) {
  double nearest = 1e300;
  for (const auto& [a, b, c] : mesh.triangles) {
    nearest =
        std::min(nearest, squared_distance_to_triangle(point, to_double(mesh.positions[a]),
                                                       to_double(mesh.positions[b]), to_double(mesh.positions[c])));
  }
  return nearest;
}

void expect_finds_nearest(const IndexedMesh& mesh, std::mt19937& random, int points) {
  const TriangleGrid grid(mesh);
  std::uniform_real_distribution<double> place(-20, 84);  // also outside of everything
  NearestTriangle found;
  for (int p = 0; p < points; ++p) {
    const Vec3d point = {place(random), place(random), place(random)};
    const std::int32_t guess = p % 2 == 0 ? -1 : found.triangle;
    found = grid.find_nearest(point, guess);
    ASSERT_NEAR(std::sqrt(found.squared_distance), std::sqrt(nearest_of_all(mesh, point)), 1e-9);
    ASSERT_GE(found.triangle, 0);
  }
}

TEST(TriangleGrid, FindsTheNearestOfRandomShapes) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  for (int round = 0; round < 10; ++round) expect_finds_nearest(test::random_shapes(random, 6), random, 100);
}

/// Large slanted triangles and slivers among many small ones cross many cells.
TEST(TriangleGrid, FindsTheNearestOfTrianglesOfAllSizes) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(0, 64);
  const auto point = [&] { return test::snap({place(random), place(random), place(random)}); };
  for (int round = 0; round < 5; ++round) {
    IndexedMesh mesh = test::sphere({32, 32, 32}, 2, 40, 40);
    for (int large = 0; large < 10; ++large) test::append(mesh, {{point(), point(), point()}, {{0, 1, 2}}});
    for (int sliver = 0; sliver < 10; ++sliver) {
      const Vec3f a = point(), b = point();
      test::append(mesh, {{a, b, {b.x + kLatticeStep, b.y, b.z}}, {{0, 1, 2}}});
    }
    expect_finds_nearest(mesh, random, 100);
  }
}

TEST(TriangleGrid, FindsTheNearestInAFlatSheet) {
  std::mt19937 random(1);
  expect_finds_nearest(test::sheet(20, 7), random, 100);
}

TEST(TriangleGrid, FindsATriangleWithoutArea) {
  std::mt19937 random(1);
  expect_finds_nearest({{{3, 3, 3}, {3, 3, 3}, {3, 3, 3}}, {{0, 1, 2}}}, random, 10);
  expect_finds_nearest({{{3, 3, 3}, {60, 3, 3}, {9, 3, 3}}, {{0, 1, 2}}}, random, 10);
}

}  // namespace
}  // namespace geosis
