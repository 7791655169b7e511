#include "engine/simplify/first_star.h"

#include <vector>

#include <gtest/gtest.h>

namespace geosis {
namespace {

using Ring = std::vector<RingTriangle>;

Fan<RingTriangle> fan_of(const Ring& ring) {
  return Fan<RingTriangle>(LocalVertex{0}, std::span(ring));
}

bool is_closed_fan(const Ring& ring) {
  ClosedFans fans(16);
  return fans.is_closed_fan(0, ring);
}

TEST(Fan, ClosedInAnyOrder) {
  for (const Ring& ring : {Ring{{1, 2}, {2, 3}, {3, 1}}, Ring{{3, 1}, {1, 2}, {2, 3}}, Ring{{1, 2}, {2, 1}}}) {
    EXPECT_TRUE(fan_of(ring).is_sound());
    EXPECT_FALSE(fan_of(ring).is_open());
    EXPECT_TRUE(is_closed_fan(ring));
  }
}

TEST(Fan, OpenOneKnowsItsEnds) {
  const Ring ring = {{3, 4}, {1, 2}, {2, 3}};
  const auto fan = fan_of(ring);
  EXPECT_TRUE(fan.is_sound());
  EXPECT_TRUE(fan.is_open());
  EXPECT_EQ(fan.first().a, 1);
  EXPECT_EQ(fan.last().b, 4);
  EXPECT_FALSE(is_closed_fan(ring));
}

TEST(Fan, WhatIsNoFanIsFoundOut) {
  const std::vector<Ring> rings = {
      {{1, 2}, {2, 1}, {3, 4}, {4, 3}},  // two closed fans
      {{1, 2}, {3, 4}},                  // two open ones
      {{1, 2}, {2, 3}, {3, 1}, {4, 5}},  // one of each
      {{1, 2}, {1, 3}},                  // an edge run along twice the same way
      {{1, 2}, {2, 3}, {4, 2}},          // the same, inwards
      {{1, 2}, {2, 3}, {3, 2}},          // a path into a loop
      {{0, 1}, {1, 2}},                  // a triangle with the vertex twice
      {{1, 1}},
  };
  for (std::size_t i = 0; i < rings.size(); ++i) {
    EXPECT_FALSE(fan_of(rings[i]).is_sound()) << i;
    EXPECT_FALSE(is_closed_fan(rings[i])) << i;
  }
}

TEST(Fan, NoTrianglesAreFine) {
  EXPECT_TRUE(fan_of({}).is_sound());
}

TEST(StartVertex, HasThePlanesOfItsTrianglesAndItsRim) {
  const std::vector<Vec3f> positions = {{0, 0, 0}, {2, 0, 0}, {0, 2, 0}};
  const auto position = [&](LocalVertex v) { return positions[v]; };
  const Ring ring = {{1, 2}};
  WorkingVertex vertex = make_vertex(positions[0], 5);
  ASSERT_TRUE(start_vertex(vertex, LocalVertex{0}, std::span<const RingTriangle>(ring), position));
  EXPECT_TRUE(vertex.on_boundary);
  EXPECT_FLOAT_EQ(vertex.quadric().value({0, 0, 1}), 2);               // the triangle's area
  EXPECT_FLOAT_EQ(vertex.quadric().value({0, 1, 0}), 4 * kRimWeight);  // the edge to (2, 0, 0), squared
  EXPECT_FLOAT_EQ(vertex.quadric().value({1, 0, 0}), 4 * kRimWeight);
}

}  // namespace
}  // namespace geosis
