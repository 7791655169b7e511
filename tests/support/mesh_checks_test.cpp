#include "tests/support/mesh_checks.h"

#include <gtest/gtest.h>

namespace geosis::test {
namespace {

// A tetrahedron with the right angle at the origin: volume 1/6.
IndexedMesh tetrahedron(Vec3f at = {0, 0, 0}) {
  return {{at, at + Vec3f{1, 0, 0}, at + Vec3f{0, 1, 0}, at + Vec3f{0, 0, 1}},
          {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
}

IndexedMesh both(IndexedMesh a, const IndexedMesh& b) {
  const auto shift = static_cast<std::int32_t>(a.positions.size());
  a.positions.insert(a.positions.end(), b.positions.begin(), b.positions.end());
  for (const Triangle& t : b.triangles) a.triangles.push_back({t[0] + shift, t[1] + shift, t[2] + shift});
  return a;
}

TEST(Census, TetrahedronIsAClosedSphere) {
  const MeshCensus c = census(tetrahedron({5, 6, 7}));
  EXPECT_TRUE(c.is_closed_manifold()) << c;
  EXPECT_EQ(c.euler(), 2);
  EXPECT_EQ(c.components, 1);
  EXPECT_NEAR(c.volume, 1.0 / 6, 1e-12);
  EXPECT_EQ(c.repeated_positions + c.off_lattice, 0) << c;
}

TEST(Census, MissingTriangleLeavesABorderOfThree) {
  IndexedMesh mesh = tetrahedron();
  mesh.triangles.pop_back();
  const MeshCensus c = census(mesh);
  EXPECT_TRUE(c.is_manifold()) << c;
  EXPECT_FALSE(c.is_closed_manifold());
  EXPECT_EQ(c.border_edges, 3);
  EXPECT_EQ(c.euler(), 1);
}

TEST(Census, TurnedTriangleDisorientsItsThreeEdges) {
  IndexedMesh mesh = tetrahedron();
  std::swap(mesh.triangles[0][0], mesh.triangles[0][1]);
  EXPECT_EQ(census(mesh).disoriented_edges, 3);
}

TEST(Census, BodiesThatShareAVertexPinchIt) {
  const IndexedMesh apart = both(tetrahedron(), tetrahedron({1, 0, 0}));
  EXPECT_TRUE(census(apart).is_closed_manifold());
  EXPECT_EQ(census(apart).components, 2);
  EXPECT_EQ(census(apart).repeated_positions, 1);
  EXPECT_EQ(census(welded(apart)).pinched_vertices, 1);
  EXPECT_EQ(census(welded(apart)).vertices, 7);
}

TEST(Census, BodiesThatShareAnEdgeCrowdIt) {
  IndexedMesh twin = tetrahedron();
  twin.positions[3] = {0, 0, -1};
  twin.positions[2] = {0, -1, 0};
  EXPECT_EQ(census(welded(both(tetrahedron(), twin))).crowded_edges, 1);
}

TEST(Census, FindsBadIndicesUnusedVerticesAndPositionsOffTheLattice) {
  IndexedMesh mesh = tetrahedron();
  mesh.triangles.push_back({0, 1, 9});
  mesh.triangles.push_back({2, 2, 1});
  mesh.positions.push_back({0.3f, 0, 0});
  const MeshCensus c = census(mesh);
  EXPECT_EQ(c.bad_indices, 2);
  EXPECT_EQ(c.unused_vertices, 1);
  EXPECT_EQ(c.off_lattice, 1);
}

}  // namespace
}  // namespace geosis::test
