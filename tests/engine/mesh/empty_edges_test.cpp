#include "engine/mesh/empty_edges.h"

#include <gtest/gtest.h>

#include "tests/support/mesh_checks.h"

namespace geosis {
namespace {

/// Vertices of a strip that closes to a tube; each is there `copies` times, one above the other in the strip's order.
IndexedMesh tube(int around, int rings, int copies) {
  IndexedMesh mesh;
  for (int ring = 0; ring < rings * copies; ++ring) {
    for (int n = 0; n < around; ++n) {
      const auto x = static_cast<float>(n < around / 2 ? n : around - n);
      const auto y = static_cast<float>(n < around / 2 ? 0 : 2);
      mesh.positions.push_back({x, y, static_cast<float>(ring / copies)});
    }
  }
  for (int ring = 0; ring + 1 < rings * copies; ++ring) {
    for (int n = 0; n < around; ++n) {
      const int a = ring * around + n, b = ring * around + (n + 1) % around, c = a + around, d = b + around;
      mesh.triangles.push_back({a, b, d});
      mesh.triangles.push_back({a, d, c});
    }
  }
  return mesh;
}

TEST(CollapseEmptyEdges, LeavesTheSurfaceAndItsType) {
  for (const int copies : {2, 3, 7}) {
    IndexedMesh mesh = tube(12, 5, copies);
    const test::MeshCensus before = test::census(mesh);
    const test::MeshCensus plain = test::census(tube(12, 5, 1));
    NoProgress progress;
    const auto index = collapse_empty_edges(mesh, progress);
    ASSERT_TRUE(index);
    const test::MeshCensus after = test::census(mesh);
    EXPECT_TRUE(after.is_manifold()) << after;
    EXPECT_EQ(after.euler(), before.euler());
    EXPECT_EQ(after.components, before.components);
    EXPECT_EQ(after.triangles, plain.triangles);
    EXPECT_EQ(after.vertices, plain.vertices);
    EXPECT_EQ(after.repeated_positions, 0);
    std::int32_t last = -1;
    for (const std::int32_t v : *index) {
      if (v < 0) continue;
      EXPECT_EQ(v, last + 1);
      last = v;
    }
    EXPECT_EQ(static_cast<std::size_t>(last + 1), mesh.positions.size());
  }
}

TEST(CollapseEmptyEdges, KeepsATubeThatHasNoWidth) {
  // All three vertices of each ring in one place: the ring cannot close to a point without cutting the tube.
  IndexedMesh mesh = tube(3, 4, 1);
  for (Vec3f& p : mesh.positions) p = {0, 0, p.z};
  const test::MeshCensus before = test::census(mesh);
  NoProgress progress;
  ASSERT_TRUE(collapse_empty_edges(mesh, progress));
  const test::MeshCensus after = test::census(mesh);
  EXPECT_TRUE(after.is_manifold()) << after;
  EXPECT_EQ(after.euler(), before.euler());
  EXPECT_EQ(after.components, before.components);
}

TEST(CollapseEmptyEdges, ChangesNothingWhereAllEdgesHaveLength) {
  IndexedMesh mesh = tube(10, 4, 1);
  const IndexedMesh before = mesh;
  NoProgress progress;
  ASSERT_TRUE(collapse_empty_edges(mesh, progress));
  EXPECT_EQ(mesh.positions, before.positions);
  EXPECT_EQ(mesh.triangles, before.triangles);
}

}  // namespace
}  // namespace geosis
