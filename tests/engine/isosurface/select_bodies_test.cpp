#include "engine/isosurface/select_bodies.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "tests/engine/isosurface/sampled_volumes.h"

namespace geosis {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
const std::vector<double> kRadii = {3.1, 6.1, 2.1, 4.1};

/// Balls of the radii above in a row; bodies by size are those at places 1, 3, 0, 2.
LabelledSurface four_balls() {
  const auto volume = sample_field({70, 16, 16}, [](int i, int j, int k) {
    double nearest = -100;
    for (std::size_t n = 0; n < kRadii.size(); ++n) {
      const double x = i - (8.0 + 17.0 * static_cast<double>(n)), y = j - 7.0, z = k - 8.0;
      nearest = std::max(nearest, kRadii[n] - std::sqrt(x * x + y * y + z * z));
    }
    return nearest;
  });
  return label(*volume, {0, kInfinity}, {}, {.seeds = {{59, 7, 8}, {42, 7, 8}, {0, 0, 0}}});
}

/// Places of the bodies that have vertices, by their numbers.
std::vector<int> places(const LabelledSurface& surface) {
  std::vector<int> places(surface.samples.size(), -1);
  for (std::size_t v = 0; v < surface.body.size(); ++v) {
    places[surface.body[v]] = static_cast<int>(surface.mesh.positions[v].x / 17);
  }
  return places;
}

TEST(SelectBodies, KeepsTheLargest) {
  LabelledSurface surface = four_balls();
  ASSERT_EQ(places(surface), (std::vector<int>{1, 3, 0, 2}));
  select_bodies(surface, {.largest = 2});
  EXPECT_EQ(places(surface), (std::vector<int>{1, 3}));
}

TEST(SelectBodies, KeepsWhatIsBigEnough) {
  LabelledSurface surface = four_balls();
  select_bodies(surface, {.min_voxels = surface.volume_voxels[2]});
  EXPECT_EQ(places(surface), (std::vector<int>{1, 3, 0}));
}

TEST(SelectBodies, KeepsWhatHoldsASeedAndForgetsSeedsOfTheRest) {
  LabelledSurface surface = four_balls();
  select_bodies(surface, {.seeded = true, .largest = 1});
  EXPECT_EQ(places(surface), (std::vector<int>{3}));
  EXPECT_EQ(surface.seed_body[0], 0u);
  EXPECT_FALSE(surface.seed_body[1] || surface.seed_body[2]);
}

TEST(SelectBodies, FiltersCombine) {
  LabelledSurface surface = four_balls();
  select_bodies(surface, {.seeded = true, .min_voxels = surface.volume_voxels[2]});
  EXPECT_EQ(places(surface), (std::vector<int>{3}));
}

TEST(SelectBodies, WhatStaysKeepsItsOrder) {
  const LabelledSurface before = four_balls();
  LabelledSurface after = before;
  select_bodies(after, {.largest = 3});
  std::vector<Vec3f> positions;
  for (std::size_t v = 0; v < before.body.size(); ++v) {
    if (before.body[v] < 3) positions.push_back(before.mesh.positions[v]);
  }
  EXPECT_EQ(after.mesh.positions, positions);
  std::size_t next = 0;
  for (const auto& [p, q, r] : before.mesh.triangles) {
    if (before.body[p] == 3) continue;
    const auto& [a, b, c] = after.mesh.triangles[next++];
    EXPECT_EQ(after.mesh.positions[a], before.mesh.positions[p]);
    EXPECT_EQ(after.mesh.positions[b], before.mesh.positions[q]);
    EXPECT_EQ(after.mesh.positions[c], before.mesh.positions[r]);
  }
  EXPECT_EQ(next, after.mesh.triangles.size());
}

TEST(SelectBodies, ABodyInACavityGoesAlone) {
  const auto volume = sample_field({21, 21, 21}, [](int i, int j, int k) {
    const double r = std::sqrt((i - 10.0) * (i - 10) + (j - 10.0) * (j - 10) + (k - 10.0) * (k - 10));
    return std::max(1.6 - std::fabs(r - 7.4), 3.1 - r);
  });
  LabelledSurface surface = label(*volume, {0, kInfinity});
  const std::vector<double> volumes = surface.volume_voxels;
  const auto inner = static_cast<std::size_t>(std::count(surface.body.begin(), surface.body.end(), 1u));
  const std::size_t all = surface.body.size();
  select_bodies(surface, {.largest = 1});
  EXPECT_EQ(surface.volume_voxels, std::vector<double>{volumes[0]});
  EXPECT_EQ(surface.body.size(), all - inner);
}

TEST(SelectBodies, NoFilterChangesNothingAndNoneCanStay) {
  LabelledSurface surface = four_balls();
  const std::size_t triangles = surface.mesh.triangles.size();
  select_bodies(surface, {});
  EXPECT_EQ(surface.mesh.triangles.size(), triangles);
  select_bodies(surface, {.min_voxels = 1e9});
  EXPECT_TRUE(surface.mesh.positions.empty() && surface.mesh.triangles.empty() && surface.samples.empty());
}

}  // namespace
}  // namespace geosis
