#include "engine/simplify/lanes/merge_rings.h"

#include <algorithm>
#include <array>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/engine/simplify/field_mesh.h"
#include "tests/support/random.h"

namespace geosis::HWY_NAMESPACE {
namespace {

using Ring = std::vector<std::pair<int, int>>;

template <class Triangles>
Ring sorted(const Triangles& triangles) {
  Ring ring;
  for (const RingTriangle t : triangles) ring.emplace_back(t.a, t.b);
  std::sort(ring.begin(), ring.end());
  return ring;
}

WindowState window_of(const IndexedMesh& mesh) {
  WindowState window;
  std::vector<LocalTriangle> triangles;
  for (const auto& [a, b, c] : mesh.triangles) {
    triangles.push_back({static_cast<LocalVertex>(a), static_cast<LocalVertex>(b), static_cast<LocalVertex>(c)});
  }
  window.vertices.resize(mesh.positions.size());
  window.rings.build(mesh.positions.size(), triangles);
  window.marks.reset(mesh.positions.size());
  return window;
}

Ring renamed(Ring ring, int v, int u) {
  std::erase_if(ring, [&](auto t) { return (t.first == u && t.second == v) || (t.first == v && t.second == u); });
  for (auto& [a, b] : ring) a = a == v ? u : a, b = b == v ? u : b;
  std::sort(ring.begin(), ring.end());
  return ring;
}

/// Merges random edges until few can, and compares every step with what the definitions say.
void merge_at_random(WindowState& window, test::Random& random, int& merged) {
  const auto vertices = static_cast<int>(window.vertices.size());
  for (int i = 0; i < 3000; ++i) {
    const auto u = static_cast<LocalVertex>(random.integer(0, vertices - 1));
    if (window.rings.degree(u) == 0 || window.rings.degree(u) > kMaxDegree) continue;
    const auto around = window.rings.of(u);
    const LocalVertex v = around[random.integer(0, static_cast<int>(around.size()) - 1)].a;
    if (window.rings.degree(v) > kMaxDegree) continue;
    MergedStar star, plain;
    const bool found = find_merged_star(u, v, window, window.marks, star);
    ASSERT_EQ(found, geosis::find_merged_star(u, v, window.vertices, window.rings, window.marks, plain));
    if (!found) continue;
    ASSERT_EQ(star.degree, plain.degree);
    ASSERT_EQ(star.from_u, plain.from_u);
    ASSERT_EQ(star.shared, plain.shared);
    ASSERT_EQ(sorted(star.triangles()), sorted(plain.triangles()));
    ASSERT_EQ(sorted(star.triangles().first(star.from_u)), sorted(plain.triangles().first(plain.from_u)));
    std::sort(star.opposite.begin(), star.opposite.end());
    std::sort(plain.opposite.begin(), plain.opposite.end());
    ASSERT_EQ(star.opposite, plain.opposite);
    std::vector<Ring> expected;
    for (int w = 0; w < vertices; ++w) expected.push_back(renamed(sorted(window.rings.of(LocalVertex(w))), v, u));
    expected[u] = sorted(star.triangles());
    expected[v] = {};
    merge_rings(window.rings, u, v, false, star);
    for (int w = 0; w < vertices; ++w) ASSERT_EQ(sorted(window.rings.of(LocalVertex(w))), expected[w]) << w;
    ++merged;
  }
}

TEST(MergeRings, DoesWhatTheDefinitionsSay) {
  const std::uint64_t seed = test::test_seed(20261127);
  test::Random random(seed);
  SCOPED_TRACE("GEOSIS_SEED=" + std::to_string(seed));
  const std::array<int, 3> shape{6, 6, 6};
  int merged = 0;
  for (int i = 0; i < 4; ++i) {
    WindowState window = window_of(mesh_field(shape, closed_on_faces(shape, noise(random.bits()))));
    merge_at_random(window, random, merged);
  }
  EXPECT_GT(merged, 200);
}

TEST(MergeRings, RemovesATriangleFromALongRing) {
  for (int size = 1; size <= 20; ++size) {
    Rings rings;
    std::vector<LocalTriangle> fan;
    for (int i = 0; i < size; ++i) fan.push_back({0, LocalVertex(i + 1), LocalVertex(i + 2)});
    rings.build(static_cast<std::size_t>(size) + 2, fan);
    remove_triangle(rings, 0, LocalVertex(size + 1), LocalVertex(size));
    EXPECT_EQ(rings.degree(0), size - 1);
    for (const RingTriangle t : rings.of(0)) EXPECT_NE(t.a, size);
  }
}

}  // namespace
}  // namespace geosis::HWY_NAMESPACE
