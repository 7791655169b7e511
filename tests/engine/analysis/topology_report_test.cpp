#include "engine/analysis/topology_report.h"

#include <gtest/gtest.h>

#include "tests/engine/mesh/tiny_meshes.h"

namespace geosis {
namespace {

void expect_report(const IndexedMesh& mesh, const TopologyReport& expected) {
  const TopologyReport report = report_topology(mesh);
  EXPECT_EQ(report.vertices, expected.vertices);
  EXPECT_EQ(report.triangles, expected.triangles);
  EXPECT_EQ(report.components, expected.components);
  EXPECT_EQ(report.euler, expected.euler);
  EXPECT_EQ(report.genus, expected.genus);
  EXPECT_EQ(report.boundary_loops, expected.boundary_loops);
  EXPECT_EQ(report.manifold, expected.manifold);
}

IndexedMesh apart(IndexedMesh mesh, const IndexedMesh& other) {
  const auto offset = static_cast<std::int32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), other.positions.begin(), other.positions.end());
  for (const auto& [a, b, c] : other.triangles) mesh.triangles.push_back({a + offset, b + offset, c + offset});
  return mesh;
}

TEST(TopologyReport, Tetrahedron) {
  expect_report(tiny::tetrahedron(),
                {.vertices = 4, .triangles = 4, .components = 1, .euler = 2, .genus = 0, .manifold = true});
}

TEST(TopologyReport, TorusHasOneHandle) {
  expect_report(tiny::torus(3, 4),
                {.vertices = 12, .triangles = 24, .components = 1, .euler = 0, .genus = 1, .manifold = true});
}

TEST(TopologyReport, DiscHasOneBoundary) {
  expect_report(
      tiny::square(),
      {.vertices = 4, .triangles = 2, .components = 1, .euler = 1, .genus = 0, .boundary_loops = 1, .manifold = true});
}

TEST(TopologyReport, AnnulusHasTwoBoundariesAndNoHandle) {
  expect_report(
      tiny::band(),
      {.vertices = 6, .triangles = 6, .components = 1, .euler = 0, .genus = 0, .boundary_loops = 2, .manifold = true});
}

TEST(TopologyReport, AddsUpComponents) {
  expect_report(apart(apart(tiny::torus(3, 3), tiny::torus(4, 5)), tiny::square()), {.vertices = 33,
                                                                                     .triangles = 60,
                                                                                     .components = 3,
                                                                                     .euler = 1,
                                                                                     .genus = 2,
                                                                                     .boundary_loops = 1,
                                                                                     .manifold = true});
}

TEST(TopologyReport, TorusWithAHoleKeepsItsHandle) {
  IndexedMesh mesh = tiny::torus(4, 4);
  mesh.triangles.pop_back();
  expect_report(mesh, {.vertices = 16,
                       .triangles = 31,
                       .components = 1,
                       .euler = -1,
                       .genus = 1,
                       .boundary_loops = 1,
                       .manifold = true});
}

TEST(TopologyReport, BowTieIsNotManifold) {
  expect_report(tiny::bow_tie(), {.vertices = 5, .triangles = 2, .components = 1, .euler = 1});
}

/// Three triangles on the edge 0-1: 5 vertices, 7 edges.
TEST(TopologyReport, ThreeTrianglesOnAnEdgeAreNotManifold) {
  expect_report(tiny::mesh(5, {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}}),
                {.vertices = 5, .triangles = 3, .components = 1, .euler = 1});
}

TEST(TopologyReport, NeighboursTurnedAgainstEachOtherAreNotManifold) {
  expect_report(tiny::mesh(4, {{0, 1, 2}, {0, 3, 2}}), {.vertices = 4, .triangles = 2, .components = 1, .euler = 1});
}

TEST(TopologyReport, UnusedVerticesDoNotCount) {
  expect_report(
      tiny::mesh(9, {{0, 4, 8}}),
      {.vertices = 3, .triangles = 1, .components = 1, .euler = 1, .genus = 0, .boundary_loops = 1, .manifold = true});
}

TEST(TopologyReport, NothingIsAManifoldWithoutComponents) {
  expect_report({}, {.manifold = true});
}

}  // namespace
}  // namespace geosis
