#include "engine/mesh/components.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "tests/engine/mesh/tiny_meshes.h"

namespace geosis {
namespace {

std::vector<ComponentTopology> measure(const IndexedMesh& mesh) {
  const auto table = build_corner_table(mesh);
  EXPECT_TRUE(table);
  return measure_components(find_components(mesh), *table);
}

/// Both meshes in one, the second one's vertices after the first one's.
IndexedMesh side_by_side(IndexedMesh a, const IndexedMesh& b) {
  const auto shift = static_cast<std::int32_t>(a.positions.size());
  for (const auto& [u, v, w] : b.triangles) a.triangles.push_back({u + shift, v + shift, w + shift});
  a.positions.insert(a.positions.end(), b.positions.begin(), b.positions.end());
  return a;
}

TEST(FindComponents, NumbersByLowestVertex) {
  //   unused: 2      components: {0, 3, 4} and {1, 5, 6}, triangles in the other order
  const IndexedMesh mesh = tiny::mesh(7, {{6, 5, 1}, {4, 3, 0}});
  const Components components = find_components(mesh);
  EXPECT_EQ(components.count, 2);
  EXPECT_EQ(components.of_vertex, (std::vector<std::int32_t>{0, 1, Components::kUnused, 0, 0, 1, 1}));
}

TEST(FindComponents, TouchingInAVertexConnects) {
  EXPECT_EQ(find_components(tiny::bow_tie()).count, 1);
}

TEST(FindComponents, DoesNotDependOnTriangleOrder) {
  IndexedMesh mesh = side_by_side(tiny::torus(4, 6), tiny::band());
  const auto before = find_components(mesh).of_vertex;
  std::reverse(mesh.triangles.begin(), mesh.triangles.end());
  EXPECT_EQ(find_components(mesh).of_vertex, before);
}

TEST(MeasureComponents, KnowsSphereTorusDiscAndBand) {
  IndexedMesh mesh = side_by_side(tiny::tetrahedron(), tiny::torus(3, 4));
  mesh = side_by_side(side_by_side(mesh, tiny::square()), tiny::band());
  const auto components = measure(mesh);
  ASSERT_EQ(components.size(), 4u);
  const std::int64_t euler[] = {2, 0, 1, 0};
  const std::int64_t genus[] = {0, 1, 0, 0};
  const std::int64_t loops[] = {0, 0, 1, 2};
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(components[i].euler(), euler[i]) << i;
    EXPECT_EQ(components[i].genus(), genus[i]) << i;
    EXPECT_EQ(components[i].boundary_loops, loops[i]) << i;
  }
}

TEST(MeasureComponents, CountsEachEdgeOnce) {
  EXPECT_EQ(measure(tiny::square())[0],
            (ComponentTopology{.vertices = 4, .edges = 5, .triangles = 2, .boundary_loops = 1}));
  EXPECT_EQ(measure(tiny::tetrahedron())[0],
            (ComponentTopology{.vertices = 4, .edges = 6, .triangles = 4, .boundary_loops = 0}));
}

}  // namespace
}  // namespace geosis
