#include "engine/simplify/lanes/edge_cost.h"

#include <algorithm>
#include <iterator>
#include <vector>

#include <gtest/gtest.h>

namespace geosis::HWY_NAMESPACE {
namespace {

WorkingVertex vertex(Vec3f position, std::vector<Vec3f> normals) {
  WorkingVertex v = make_vertex(position, 0);
  Quadric quadric;
  for (const Vec3f n : normals) add_plane(quadric, n, 1.0f);
  v.set_quadric(quadric);
  return v;
}

Vec3f best(const WorkingVertex& u, const WorkingVertex& v) {
  const Vec3f edge = v.position - u.position;
  return u.position + best_point(u.quadric() + seen_from(v.quadric(), edge), edge, merge_target(u, v));
}

TEST(BestPoint, FindsTheCornerWhereThreePlanesMeet) {
  const auto u = vertex({10, 0, 0}, {{1, 0, 0}, {0, 1, 0}});
  const auto v = vertex({10.5f, 1, 1}, {{0, 0, 1}});
  const Vec3f p = best(u, v);
  EXPECT_NEAR(p.x, 10, 0.01);
  EXPECT_NEAR(p.y, 0, 0.01);
  EXPECT_NEAR(p.z, 1, 0.01);
}

TEST(BestPoint, IsTheMiddleWhereAllIsFlat) {
  const auto u = vertex({0, 0, 5}, {{0, 0, 1}});
  const auto v = vertex({2, 4, 5}, {{0, 0, 1}});
  EXPECT_EQ(best(u, v), (Vec3f{1, 2, 5}));
}

TEST(BestPoint, IsTheMiddleWhereNothingIsKnown) {
  EXPECT_EQ(best(vertex({0, 0, 0}, {}), vertex({1, 2, 4}, {})), (Vec3f{0.5f, 1, 2}));
}

TEST(BestPoint, LeavesABoundaryVertexInPlace) {
  auto u = vertex({0, 0, 5}, {{0, 0, 1}});
  auto v = vertex({2, 4, 5}, {{0, 0, 1}, {1, 0, 0}});
  v.on_boundary = true;
  EXPECT_EQ(best(u, v), v.position);
  EXPECT_EQ(best(v, u), v.position);
}

TEST(BestPoint, IsTheCheaperEndInASubset) {
  const auto u = vertex({0, 0, 0}, {{1, 0, 0}});
  const auto v = vertex({3, 0, 0}, {{0, 1, 0}, {0.5f, 0, 0}});
  const Vec3f edge = v.position - u.position;
  const Quadric sum = u.quadric() + seen_from(v.quadric(), edge);
  EXPECT_EQ(best_point(sum, edge, MergeTarget::best, Placement::subset), (Vec3f{0, 0, 0}));
  EXPECT_EQ(
      best_point(seen_from(sum, Vec3f{0, 0, 0} - edge), Vec3f{0, 0, 0} - edge, MergeTarget::best, Placement::subset),
      Vec3f({0, 0, 0}) - edge);
}

std::vector<WorkingVertex> different_vertices() {
  std::vector<WorkingVertex> vertices;
  for (int i = 0; i < 12; ++i) {
    const auto x = static_cast<float>(i);
    vertices.push_back(vertex({x, x * x / 16, 3 - x}, {{1, x, 0.5f}, {x, -1, 2}}));
    vertices.back().on_boundary = i % 3 == 0;
  }
  return vertices;
}

TEST(EdgeCosts, LanesGiveWhatOneEdgeGives) {
  const auto vertices = different_vertices();
  const WorkingVertex *u[kLanes], *v[kLanes];
  for (int i = 0; i < kLanes; ++i) u[i] = &vertices[i], v[i] = &vertices[(3 * i + 1) % 12];
  for (const Placement placement : {Placement::optimal, Placement::subset}) {
    float together[kLanes];
    edge_costs(u, v, together, placement);
    for (int i = 0; i < kLanes; ++i) {
      const WorkingVertex* to[kLanes];
      std::fill(std::begin(to), std::end(to), v[i]);
      float alone[kLanes];
      edge_costs(*u[i], to, alone, placement);
      EXPECT_EQ(together[i], alone[0]) << i;
    }
  }
}

TEST(EdgeCosts, FlatEdgesCostTheirLengthOnly) {
  const std::vector<WorkingVertex> vertices = {vertex({0, 0, 0}, {{0, 0, 1}}), vertex({1, 0, 0}, {{0, 0, 1}}),
                                               vertex({0, 3, 0}, {{0, 0, 1}}), vertex({0, 1, 1}, {{0, 0, 1}})};
  const WorkingVertex* to[kLanes];
  for (int i = 0; i < kLanes; ++i) to[i] = &vertices[std::min(i + 1, 3)];
  float costs[kLanes];
  edge_costs(vertices[0], to, costs);
  EXPECT_LT(costs[0], costs[1]);
  EXPECT_LT(costs[1], 0.01f);
  EXPECT_GT(costs[2], 0.1f);
}

}  // namespace
}  // namespace geosis::HWY_NAMESPACE
