#include "engine/simplify/rings.h"

#include <algorithm>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace geosis {
namespace {

using Pairs = std::vector<std::pair<int, int>>;

Pairs ring_of(const Rings& rings, LocalVertex v) {
  Pairs result;
  for (const RingTriangle t : rings.of(v)) result.emplace_back(t.a, t.b);
  std::sort(result.begin(), result.end());
  return result;
}

//   3---2
//   | / |
//   0---1
Rings square() {
  Rings rings;
  const LocalTriangle triangles[] = {{0, 1, 2}, {0, 2, 3}};
  rings.build(4, triangles);
  return rings;
}

TEST(Rings, ListEachVertexsTriangles) {
  const Rings rings = square();
  EXPECT_EQ(ring_of(rings, 0), (Pairs{{1, 2}, {2, 3}}));
  EXPECT_EQ(ring_of(rings, 1), (Pairs{{2, 0}}));
  EXPECT_EQ(ring_of(rings, 2), (Pairs{{0, 1}, {3, 0}}));
}

TEST(Rings, MergedRingTakesAnyRoom) {
  for (int size = 1; size <= 24; ++size) {
    Rings rings = square();
    std::vector<RingTriangle> merged;
    Pairs expected;
    for (int i = 0; i < size; ++i) {
      merged.push_back({static_cast<LocalVertex>(i), static_cast<LocalVertex>(i + 1)});
      expected.emplace_back(i, i + 1);
    }
    rings.merge(0, 1, merged);
    EXPECT_EQ(ring_of(rings, 0), expected);
    EXPECT_EQ(rings.degree(1), 0);
    EXPECT_EQ(ring_of(rings, 2), (Pairs{{0, 1}, {3, 0}})) << "another ring was overwritten";
  }
}

}  // namespace
}  // namespace geosis
