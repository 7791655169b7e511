#include "engine/mesh/operators.h"

#include <algorithm>
#include <array>
#include <set>
#include <utility>

#include <gtest/gtest.h>

#include "engine/mesh/check.h"
#include "engine/mesh/components.h"
#include "tests/engine/mesh/tiny_meshes.h"
#include "tests/support/random.h"

namespace geosis {
namespace {

using Faces = std::multiset<std::array<std::int32_t, 3>>;

CornerTable table_of(const IndexedMesh& mesh) {
  auto table = build_corner_table(mesh);
  EXPECT_TRUE(table) << (table ? std::string() : table.error().message);
  return *std::move(table);
}

IndexedMesh mesh_of(const CornerTable& table, std::size_t vertices) {
  IndexedMesh mesh{std::vector<Vec3f>(vertices), {}};
  for (std::int32_t c = 0; c < table.corners(); c += 3) {
    if (table.vertex[c] != kGone) mesh.triangles.push_back({table.vertex[c], table.vertex[c + 1], table.vertex[c + 2]});
  }
  return mesh;
}

/// Triangles, each turned so that its lowest vertex is first.
Faces faces_of(const CornerTable& table) {
  Faces faces;
  for (auto triangle : mesh_of(table, 0).triangles) {
    std::rotate(triangle.begin(), std::min_element(triangle.begin(), triangle.end()), triangle.end());
    faces.insert(triangle);
  }
  return faces;
}

/// Euler characteristic and boundary loops of each component, sorted, by a table built anew.
std::vector<std::pair<std::int64_t, std::int64_t>> type_of(const CornerTable& table, std::size_t vertices) {
  const IndexedMesh mesh = mesh_of(table, vertices);
  const auto sound = check_manifold(mesh);
  EXPECT_TRUE(sound) << (sound ? std::string() : sound.error().message);
  std::vector<std::pair<std::int64_t, std::int64_t>> type;
  for (const auto& component : measure_components(find_components(mesh), table_of(mesh))) {
    type.emplace_back(component.euler(), component.boundary_loops);
  }
  std::sort(type.begin(), type.end());
  return type;
}

/// Opposite corners must be those that a table built anew finds.
void expect_sound(const CornerTable& table, std::size_t vertices) {
  const CornerTable packed = remove_gone_triangles(table);
  const CornerTable anew = table_of(mesh_of(table, vertices));
  EXPECT_EQ(packed.vertex, anew.vertex);
  EXPECT_EQ(packed.opposite, anew.opposite);
}

/// The corner of the triangle (a, b, c) at a.
std::int32_t corner(const CornerTable& table, std::int32_t a, std::int32_t b) {
  for (std::int32_t c = 0; c < table.corners(); ++c) {
    if (table.vertex[c] == a && table.vertex[CornerTable::next(c)] == b) return c;
  }
  ADD_FAILURE() << "no triangle on " << a << ", " << b;
  return 0;
}

///     1
///   / | \        an octahedron: 0 and 5 are the poles, 1 2 3 4 the equator
IndexedMesh octahedron() {
  return tiny::mesh(6, {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 1}, {5, 2, 1}, {5, 3, 2}, {5, 4, 3}, {5, 1, 4}});
}

/// Rows x columns quads in a plane, each cut in two.
IndexedMesh sheet(int rows, int columns) {
  std::vector<Triangle> triangles;
  const auto at = [&](int r, int c) { return r * (columns + 1) + c; };
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < columns; ++c) {
      triangles.push_back({at(r, c), at(r, c + 1), at(r + 1, c + 1)});
      triangles.push_back({at(r, c), at(r + 1, c + 1), at(r + 1, c)});
    }
  }
  return tiny::mesh(static_cast<std::size_t>(rows + 1) * (columns + 1), std::move(triangles));
}

TEST(FlipEdge, TurnsTheDiagonalOfASquareAndBack) {
  CornerTable table = table_of(tiny::square());
  ASSERT_TRUE(flip_edge(table, corner(table, 1, 2)));
  EXPECT_EQ(faces_of(table), (Faces{{0, 1, 3}, {1, 2, 3}}));
  expect_sound(table, 4);
  ASSERT_TRUE(flip_edge(table, corner(table, 0, 1)));
  EXPECT_EQ(faces_of(table), (Faces{{0, 1, 2}, {0, 2, 3}}));
}

TEST(FlipEdge, IsRefusedOnABoundaryAndWhereTheEdgeExists) {
  CornerTable square = table_of(tiny::square());
  EXPECT_FALSE(flip_edge(square, corner(square, 0, 1)));
  CornerTable tetrahedron = table_of(tiny::tetrahedron());
  const CornerTable before = tetrahedron;
  for (std::int32_t c = 0; c < 12; ++c) EXPECT_FALSE(flip_edge(tetrahedron, c));
  EXPECT_EQ(tetrahedron.opposite, before.opposite);
}

TEST(CollapseEdge, MergesAPoleIntoTheEquator) {
  CornerTable table = table_of(octahedron());
  ASSERT_TRUE(collapse_edge(table, corner(table, 2, 0)));  // faces 0 -> 1: 1 merges into 0
  EXPECT_EQ(faces_of(table), (Faces{{0, 2, 3}, {0, 3, 4}, {0, 5, 2}, {0, 4, 5}, {2, 5, 3}, {3, 5, 4}}));
  expect_sound(table, 6);
}

TEST(CollapseEdge, IsRefusedWhereTheTypeWouldChange) {
  CornerTable tetrahedron = table_of(tiny::tetrahedron());
  EXPECT_FALSE(collapse_edge(tetrahedron, 0));
  CornerTable square = table_of(tiny::square());
  EXPECT_FALSE(collapse_edge(square, corner(square, 1, 2)));  // the diagonal joins two boundary vertices
  EXPECT_TRUE(collapse_edge(square, corner(square, 0, 1)));
  for (std::int32_t c = 0; c < 6; ++c) {  // one triangle is left
    EXPECT_FALSE(square.vertex[c] != kGone && collapse_edge(square, c));
  }
  CornerTable band = table_of(tiny::band());
  for (std::int32_t c = 0; c < band.corners(); ++c) EXPECT_FALSE(collapse_edge(band, c)) << c;  // loops of three edges
}

TEST(WeldEdge, TakesOutAVertexThatSplitAnEdge) {
  CornerTable table = table_of(octahedron());
  ASSERT_TRUE(weld_edge(table, corner(table, 0, 1)));  // previous: 2
  EXPECT_EQ(faces_of(table), (Faces{{1, 2, 4}, {2, 3, 4}, {1, 5, 2}, {2, 5, 3}, {3, 5, 4}, {1, 4, 5}}));
  expect_sound(table, 6);
}

TEST(WeldEdge, IsRefusedForOtherNumbersOfTriangles) {
  CornerTable table = table_of(sheet(3, 3));
  EXPECT_FALSE(weld_edge(table, corner(table, 5, 6)));  // an inner vertex with six
  EXPECT_FALSE(weld_edge(table, corner(table, 1, 2)));  // a boundary vertex with three
}

TEST(CollapseFace, LeavesAStarOfItsSurroundings) {
  CornerTable table = table_of(sheet(4, 4));
  ASSERT_TRUE(collapse_face(table, corner(table, 6, 7)));  // 6, 7, 12 merge
  EXPECT_EQ(mesh_of(table, 25).triangles.size(), 32u - 4u);
  EXPECT_EQ(type_of(table, 25), type_of(table_of(sheet(4, 4)), 25));
  expect_sound(table, 25);
  for (const std::int32_t v : table.vertex) EXPECT_TRUE(v != 7 && v != 12);
}

TEST(CollapseFace, LeavesTheTableAsItWasWhenRefused) {
  // Two tetrahedra on one face: the first of the two vertices can merge, the second can not.
  CornerTable table = table_of(tiny::mesh(5, {{0, 1, 3}, {1, 2, 3}, {2, 0, 3}, {1, 0, 4}, {2, 1, 4}, {0, 2, 4}}));
  const CornerTable before = table;
  int refused = 0;
  for (std::int32_t c = 0; c < table.corners(); ++c) {
    CornerTable changed = table;
    if (collapse_face(changed, c)) continue;
    ++refused;
    EXPECT_EQ(changed.vertex, before.vertex);
    EXPECT_EQ(changed.opposite, before.opposite);
  }
  EXPECT_EQ(refused, 18);
}

TEST(CollapseStar, MergesAVertexWithAllAroundIt) {
  CornerTable table = table_of(sheet(6, 6));
  ASSERT_TRUE(collapse_star(table, corner(table, 24, 25)));
  EXPECT_EQ(mesh_of(table, 49).triangles.size(), 72u - 12u);
  EXPECT_EQ(type_of(table, 49), type_of(table_of(sheet(6, 6)), 49));
  expect_sound(table, 49);
}

TEST(CollapseStar, IsRefusedOnTheBoundaryAndWhereTheTypeWouldChange) {
  CornerTable table = table_of(sheet(3, 3));
  EXPECT_FALSE(collapse_star(table, corner(table, 1, 2)));
  CornerTable small = table_of(octahedron());
  const CornerTable before = small;
  EXPECT_FALSE(collapse_star(small, 0));
  EXPECT_EQ(small.vertex, before.vertex);
  EXPECT_EQ(small.opposite, before.opposite);
}

bool apply_some_operator(CornerTable& table, std::int32_t c, int which) {
  switch (which) {
    case 0:
      return flip_edge(table, c);
    case 1:
      return collapse_edge(table, c);
    case 2:
      return weld_edge(table, c);
    case 3:
      return collapse_face(table, c);
    default:
      return collapse_star(table, c);
  }
}

TEST(Operators, KeepTheTopologicalTypeInAnyOrder) {
  const std::uint64_t seed = test::test_seed(20261126);
  SCOPED_TRACE("seed " + std::to_string(seed));
  test::Random random(seed);
  for (const IndexedMesh& mesh : {tiny::torus(9, 11), sheet(8, 9), octahedron(), tiny::torus(4, 5)}) {
    const auto type = type_of(table_of(mesh), mesh.positions.size());
    for (int run = 0; run < 20; ++run) {
      CornerTable table = table_of(mesh);
      std::array<int, 5> done{};
      for (int step = 0; step < 60; ++step) {
        const std::int32_t c = random.integer(0, table.corners() - 1);
        const int which = random.integer(0, 4);
        if (table.vertex[c] != kGone) done[which] += apply_some_operator(table, c, which);
      }
      ASSERT_EQ(type_of(table, mesh.positions.size()), type) << "run " << run;
      expect_sound(table, mesh.positions.size());
    }
  }
}

}  // namespace
}  // namespace geosis
