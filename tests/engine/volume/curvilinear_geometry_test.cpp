#include "engine/volume/curvilinear_geometry.h"

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace geosis {
namespace {

constexpr GridShape kShape = {6, 5, 7};

/// Nodes of a grid that place() puts anywhere.
template <class Place>
std::vector<Vec3d> nodes_of(const Place& place) {
  std::vector<Vec3d> nodes;
  for (int i = 0; i < kShape.inlines; ++i) {
    for (int j = 0; j < kShape.crosslines; ++j) {
      for (int k = 0; k < kShape.samples; ++k) nodes.push_back(place(i, j, k));
    }
  }
  return nodes;
}

Vec3d plain(int i, int j, int k) {
  return {1e6 + 25.0 * i, 2e6 + 12.5 * j, 1000 + 4.0 * k};
}

TEST(CurvilinearGeometry, IsTrilinearBetweenItsNodes) {
  const auto geometry = CurvilinearGeometry::from_nodes(kShape, nodes_of(plain));
  ASSERT_TRUE(geometry) << geometry.error().message;
  EXPECT_FALSE(geometry->mirrored());
  EXPECT_EQ(geometry->report().folded_share, 0);
  for (const Vec3d p : {Vec3d{0, 0, 0}, {5, 4, 6}, {2.5, 1.25, 3.75}, {-1, 5, 7}}) {
    const Vec3d at = geometry->map(p);
    EXPECT_NEAR(at.x, 1e6 + 25 * p.x, 1e-3);
    EXPECT_NEAR(at.y, 2e6 + 12.5 * p.y, 1e-3);
    EXPECT_NEAR(at.z, 1000 + 4 * p.z, 1e-3);
  }
}

TEST(CurvilinearGeometry, FindsItsHandedness) {
  const auto mirrored = CurvilinearGeometry::from_nodes(kShape, nodes_of([](int i, int j, int k) {
                                                          return Vec3d{1.0 * j, 1.0 * i, 1.0 * k};
                                                        }));
  ASSERT_TRUE(mirrored);
  EXPECT_TRUE(mirrored->mirrored());
}

TEST(CurvilinearGeometry, TakesPillars) {
  std::vector<Pillar> pillars;
  std::vector<double> depths;
  for (int i = 0; i < kShape.inlines; ++i) {
    for (int j = 0; j < kShape.crosslines; ++j) {
      pillars.push_back({{10.0 * i, 10.0 * j, 0}, {10.0 * i + 5, 10.0 * j, 10}});
      for (int k = 0; k < kShape.samples; ++k) depths.push_back(2.0 * k + i);
    }
  }
  const auto geometry = CurvilinearGeometry::from_pillars(kShape, pillars, depths);
  ASSERT_TRUE(geometry) << geometry.error().message;
  const Vec3d at = geometry->map({3, 2, 4});  // depth 11, on the way from top to bottom and a little beyond
  EXPECT_NEAR(at.x, 30 + 5.5, 1e-5);
  EXPECT_NEAR(at.y, 20, 1e-5);
  EXPECT_NEAR(at.z, 11, 1e-5);
  pillars[7].bottom.z = 0;
  const auto level = CurvilinearGeometry::from_pillars(kShape, pillars, depths);
  ASSERT_FALSE(level);
  EXPECT_EQ(level.error().message, "node positions: the pillar of trace [1,2] has both ends at one depth");
  EXPECT_FALSE(CurvilinearGeometry::from_pillars(kShape, std::span(pillars).first(3), depths));
}

TEST(CurvilinearGeometry, RefusesNodesThatMakeNoGrid) {
  auto nodes = nodes_of(plain);
  EXPECT_EQ(CurvilinearGeometry::from_nodes(kShape, std::span(nodes).first(9)).error().message,
            "node positions: 9; the volume has 210 nodes");
  nodes[35 * 2 + 7 * 3 + 4].y = std::numeric_limits<double>::infinity();
  EXPECT_EQ(CurvilinearGeometry::from_nodes(kShape, nodes).error().message,
            "node positions: node [2,3,4] is (1000050, inf, 1016): not finite");
  EXPECT_FALSE(CurvilinearGeometry::from_nodes({6, 5, 1}, std::span(nodes).first(30)));
  const auto folded = CurvilinearGeometry::from_nodes(kShape, nodes_of([](int i, int j, int k) {
                                                        return Vec3d{i == 3 ? 1.5 : i, 1.0 * j, 1.0 * k};
                                                      }));
  ASSERT_FALSE(folded);
  EXPECT_EQ(folded.error().code, ErrorCode::malformed_input);
  EXPECT_EQ(folded.error().message,
            "node positions: 20.0 % of the cells are folded; at most 1 %; the first is that from node [2,0,0]");
}

TEST(CurvilinearGeometry, ToleratesFlatCells) {
  const auto pinched = CurvilinearGeometry::from_nodes(kShape, nodes_of([](int i, int j, int k) {
                                                         return Vec3d{1.0 * i, 1.0 * j, std::min(k, 4) * 1.0};
                                                       }));
  ASSERT_TRUE(pinched);
  EXPECT_EQ(pinched->report().folded_share, 0);
}

}  // namespace
}  // namespace geosis
