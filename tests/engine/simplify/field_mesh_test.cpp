#include "tests/engine/simplify/field_mesh.h"

#include <gtest/gtest.h>

#include "engine/mesh/check.h"
#include "engine/mesh/components.h"
#include "tests/engine/simplify/level_checks.h"

namespace geosis {
namespace {

TEST(FieldMesh, BallIsASphereThatLooksOutwards) {
  const IndexedMesh mesh = mesh_field({12, 12, 12}, ball({5.5, 5.4, 5.6}, 4));
  ASSERT_EQ(topology_of(mesh).size(), 1u);
  EXPECT_EQ(topology_of(mesh)[0].euler(), 2);
  double volume = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    volume += dot(to_double(mesh.positions[a]), cross(to_double(mesh.positions[b]), to_double(mesh.positions[c]))) / 6;
  }
  EXPECT_NEAR(volume, 4.0 / 3 * 3.14159 * 64, 12);
}

TEST(FieldMesh, NoiseIsManifoldWithBoundary) {
  const IndexedMesh mesh = mesh_field({12, 13, 14}, noise(3));
  EXPECT_TRUE(check_manifold(mesh));
  EXPECT_EQ(fault_of_shape(mesh), "none");
}

TEST(FieldMesh, TorusHasAHandle) {
  const auto topology = topology_of(mesh_field({24, 24, 12}, torus({11.5, 11.5, 5.5}, 7, 3)));
  ASSERT_EQ(topology.size(), 1u);
  EXPECT_EQ(topology[0].genus(), 1);
}

}  // namespace
}  // namespace geosis
