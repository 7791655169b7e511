#include "engine/mesh/check.h"

#include <gtest/gtest.h>

#include "tests/engine/mesh/tiny_meshes.h"

namespace geosis {
namespace {

std::string fault_of(const IndexedMesh& mesh) {
  const auto checked = check_manifold(mesh);
  return checked ? "none" : checked.error().message;
}

TEST(CheckManifold, AcceptsClosedAndOpenSurfaces) {
  EXPECT_EQ(fault_of({}), "none");
  EXPECT_EQ(fault_of(tiny::square()), "none");
  EXPECT_EQ(fault_of(tiny::tetrahedron()), "none");
  EXPECT_EQ(fault_of(tiny::torus(3, 3)), "none");
  EXPECT_EQ(fault_of(tiny::band()), "none");
}

TEST(CheckManifold, NamesTheVertexOfABowTie) {
  EXPECT_EQ(fault_of(tiny::bow_tie()),
            "vertex 0 has more than one fan: 1 of its 2 triangles are connected across edges");
}

TEST(CheckManifold, NamesTheVertexWhereTwoTetrahedraTouch) {
  IndexedMesh mesh = tiny::tetrahedron();
  for (Triangle t : tiny::tetrahedron().triangles) {
    for (std::int32_t& v : t) v = v == 3 ? 3 : v + 4;  // the second one has vertices 4, 5, 6 and shares 3
    mesh.triangles.push_back(t);
  }
  mesh.positions.resize(7);
  EXPECT_EQ(fault_of(mesh), "vertex 3 has more than one fan: 3 of its 6 triangles are connected across edges");
}

TEST(CheckManifold, RefusesTwoTrianglesBackToBack) {
  EXPECT_EQ(fault_of(tiny::mesh(3, {{0, 1, 2}, {0, 2, 1}})), "triangles 0 and 1 have the same three vertices");
}

TEST(CheckManifold, RefusesTheSameTriangleTwice) {
  EXPECT_EQ(fault_of(tiny::mesh(3, {{0, 1, 2}, {1, 2, 0}})),
            "triangles 0 and 1 run in the same direction along the edge of vertices 0 and 1");
}

TEST(CheckManifold, SaysWhatTheCornerTableFound) {
  EXPECT_EQ(fault_of(tiny::mesh(2, {{0, 1, 1}})), "triangle 0 names vertex 1 twice");
}

}  // namespace
}  // namespace geosis
