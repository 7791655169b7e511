#include "engine/mesh/corner_table.h"

#include <gtest/gtest.h>

#include "tests/engine/mesh/tiny_meshes.h"

namespace geosis {
namespace {

std::string fault_of(const IndexedMesh& mesh) {
  const auto table = build_corner_table(mesh);
  if (table) return "none";
  EXPECT_EQ(table.error().code, ErrorCode::invalid_argument);
  return table.error().message;
}

TEST(CornerTable, OppositeOfOppositeIsTheSameCorner) {
  for (const IndexedMesh& mesh : {tiny::square(), tiny::tetrahedron(), tiny::torus(4, 5), tiny::band()}) {
    const auto table = build_corner_table(mesh);
    ASSERT_TRUE(table);
    for (std::int32_t c = 0; c < table->corners(); ++c) {
      const std::int32_t o = table->opposite[c];
      EXPECT_TRUE(o == CornerTable::kNoCorner || table->opposite[o] == c) << "corner " << c;
    }
  }
}

TEST(CornerTable, OppositeCornersFaceTheSameEdgeBackwards) {
  const auto table = build_corner_table(tiny::torus(3, 7));
  ASSERT_TRUE(table);
  for (std::int32_t c = 0; c < table->corners(); ++c) {
    const std::int32_t o = table->opposite[c];
    ASSERT_NE(o, CornerTable::kNoCorner);
    EXPECT_EQ(table->vertex[CornerTable::next(c)], table->vertex[CornerTable::previous(o)]);
    EXPECT_EQ(table->vertex[CornerTable::previous(c)], table->vertex[CornerTable::next(o)]);
  }
}

TEST(CornerTable, SquareMeetsAcrossItsDiagonalOnly) {
  const auto table = build_corner_table(tiny::square());
  ASSERT_TRUE(table);
  EXPECT_EQ(table->opposite, (std::vector<std::int32_t>{-1, 5, -1, -1, -1, 1}));
}

TEST(CornerTable, BoundaryWalkGoesAroundTheSquare) {
  const auto table = build_corner_table(tiny::square());
  ASSERT_TRUE(table);
  std::vector<std::int32_t> from;
  std::int32_t c = 2;  // faces 0 -> 1
  for (int i = 0; i < 4; ++i, c = table->next_on_boundary(c)) from.push_back(table->vertex[CornerTable::next(c)]);
  EXPECT_EQ(from, (std::vector<std::int32_t>{0, 1, 2, 3}));
  EXPECT_EQ(c, 2);
}

TEST(CornerTable, SwingTurnsAroundTheVertexAndBack) {
  const auto table = build_corner_table(tiny::torus(4, 4));
  ASSERT_TRUE(table);
  std::int32_t c = 0;
  for (int i = 0; i < 6; ++i) {
    c = table->swing(c);
    ASSERT_EQ(table->vertex[c], table->vertex[0]);
  }
  EXPECT_EQ(c, 0);
}

TEST(CornerTable, EmptyMeshHasNoCorners) {
  const auto table = build_corner_table({});
  ASSERT_TRUE(table);
  EXPECT_EQ(table->corners(), 0);
}

TEST(CornerTable, RefusesVertexOutOfRange) {
  EXPECT_EQ(fault_of(tiny::mesh(3, {{0, 1, 2}, {0, 2, 3}})), "triangle 1: vertex index 3; expected 0..2");
  EXPECT_EQ(fault_of(tiny::mesh(3, {{0, -1, 2}})), "triangle 0: vertex index -1; expected 0..2");
}

TEST(CornerTable, RefusesRepeatedVertex) {
  EXPECT_EQ(fault_of(tiny::mesh(3, {{0, 1, 2}, {1, 2, 1}})), "triangle 1 names vertex 1 twice");
}

TEST(CornerTable, RefusesThreeTrianglesOnAnEdge) {
  EXPECT_EQ(fault_of(tiny::mesh(5, {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}})),
            "edge of vertices 0 and 1 lies in 3 triangles: 0 1 2");
}

TEST(CornerTable, RefusesFlippedNeighbour) {
  EXPECT_EQ(fault_of(tiny::mesh(4, {{0, 1, 2}, {0, 3, 2}})),
            "triangles 0 and 1 run in the same direction along the edge of vertices 0 and 2");
}

}  // namespace
}  // namespace geosis
