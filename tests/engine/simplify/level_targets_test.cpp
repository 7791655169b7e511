// What a level may be asked for besides a ratio, and how: error, cost, caps, specks, strategy and placement.

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <gtest/gtest.h>

#include "engine/mesh/components.h"
#include "engine/simplify/build_lods.h"
#include "engine/simplify/window_sizes.h"
#include "tests/engine/simplify/field_mesh.h"
#include "tests/engine/simplify/level_checks.h"

namespace geosis {
namespace {

constexpr WindowSizes kSmallWindows = {.pass = 256, .last_pass = 1024, .whole_mesh = 64};
constexpr double kInfinity = std::numeric_limits<double>::infinity();

LodHierarchy lods(const IndexedMesh& m0, const BuildLodsOptions& options, const WindowSizes& sizes = {}) {
  NoProgress progress;
  auto built = build_lods_in_windows(m0, options, sizes, progress);
  EXPECT_TRUE(built) << (built ? std::string() : built.error().message);
  return built ? *std::move(built) : LodHierarchy{};
}

IndexedMesh gyroid_mesh() {
  return mesh_field({26, 26, 26}, gyroid(12, 0.2));
}

/// A ball of radius 8 and 18 specks of one sample each.
IndexedMesh ball_among_specks() {
  const NodeField body = ball({14, 14, 14}, 8);
  return mesh_field({29, 29, 29}, [=](int i, int j, int k) {
    const bool speck = i % 9 == 2 && j % 9 == 2 && (k == 2 || k == 26);
    return speck ? -0.5 : body(i, j, k);
  });
}

double volume_of(const IndexedMesh& mesh) {
  double six = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    six += dot(to_double(mesh.positions[a]), cross(to_double(mesh.positions[b]), to_double(mesh.positions[c])));
  }
  return six / 6;
}

/// Largest distance from some of a's vertices to the nearest of b's: coarse, but shares nothing with what it tests.
double vertex_distance(const IndexedMesh& a, const IndexedMesh& b) {
  double farthest = 0;
  for (std::size_t v = 0; v < a.positions.size(); v += 7) {
    const Vec3f p = a.positions[v];
    double nearest = kInfinity;
    for (const Vec3f& q : b.positions) nearest = std::min(nearest, norm(to_double(p - q)));
    farthest = std::max(farthest, nearest);
  }
  return farthest;
}

MeasureError to_nearest_vertex() {
  return [](const IndexedMesh& from, const IndexedMesh& to) { return vertex_distance(to, from); };
}

/// Of levels whose vertices are all on M0.
MeasureError to_nearest_vertex_of_level() {
  return [](const IndexedMesh& from, const IndexedMesh& to) { return vertex_distance(from, to); };
}

TEST(LevelTargets, VolumeDriftsByLessThanHalfAPercent) {
  for (const IndexedMesh& m0 : {mesh_field({40, 40, 40}, ball({19.5, 19.4, 19.6}, 16)),
                                mesh_field({40, 40, 18}, torus({19.5, 19.5, 8.5}, 12, 5))}) {
    const LodHierarchy hierarchy = lods(m0, {.levels = by_ratio({0.25, 0.0625})});
    for (const LodLevel& level : hierarchy.levels) {
      EXPECT_NEAR(volume_of(level.mesh) / volume_of(m0), 1, 0.005) << level.mesh.triangles.size();
    }
  }
}

TEST(LevelTargets, MultipleChoiceKeepsTopologyAndReachesItsRatios) {
  const IndexedMesh m0 = gyroid_mesh();
  for (const WindowSizes& sizes : {WindowSizes{}, kSmallWindows}) {
    const LodHierarchy hierarchy =
        lods(m0, {.levels = by_ratio({0.25, 0.1}), .strategy = Strategy::multiple_choice, .seed = 7}, sizes);
    double ratio = 0.25;
    for (const LodLevel& level : hierarchy.levels) {
      const double asked = std::exchange(ratio, 0.1) * static_cast<double>(m0.triangles.size());
      EXPECT_NEAR(static_cast<double>(level.mesh.triangles.size()), asked, 0.01 * asked + 2);
      EXPECT_EQ(sorted_topology_of(level.mesh), sorted_topology_of(m0));
      EXPECT_EQ(fault_of_shape(level.mesh), "none");
    }
  }
}

TEST(LevelTargets, SeedDecidesWhatMultipleChoiceGives) {
  const IndexedMesh m0 = gyroid_mesh();
  const auto with_seed = [&](std::uint64_t seed) {
    return lods(m0, {.levels = by_ratio({0.2}), .strategy = Strategy::multiple_choice, .seed = seed}).levels[0].mesh;
  };
  EXPECT_EQ(with_seed(1).positions, with_seed(1).positions);
  EXPECT_NE(with_seed(1).positions, with_seed(2).positions);
}

/// All levels are parts of m0's positions, and each the first of those of every larger one.
void expect_one_vertex_array(const IndexedMesh& m0, const LodHierarchy& hierarchy) {
  for (const LodLevel& level : hierarchy.levels) {
    const std::vector<Vec3f>& own = level.mesh.positions;
    for (const LodLevel& other : hierarchy.levels) {
      if (other.mesh.positions.size() < own.size()) continue;
      EXPECT_TRUE(std::equal(own.begin(), own.end(), other.mesh.positions.begin()));
    }
    for (std::size_t v = 0; v < own.size(); ++v) EXPECT_EQ(own[v], m0.positions[level.origin[v]]);
    EXPECT_EQ(fault_of_shape(level.mesh), "none");
  }
}

TEST(LevelTargets, SubsetLevelsShareOneVertexArray) {
  const IndexedMesh m0 = gyroid_mesh();
  for (const WindowSizes& sizes : {WindowSizes{}, kSmallWindows}) {
    const LodHierarchy hierarchy =
        lods(m0, {.levels = by_ratio({1, 0.25, 0.0625}), .placement = Placement::subset}, sizes);
    EXPECT_GT(hierarchy.levels[0].mesh.positions.size(), hierarchy.levels[1].mesh.positions.size());
    EXPECT_GT(hierarchy.levels[1].mesh.positions.size(), hierarchy.levels[2].mesh.positions.size());
    expect_one_vertex_array(m0, hierarchy);
    for (const LodLevel& level : hierarchy.levels) EXPECT_EQ(sorted_topology_of(level.mesh), sorted_topology_of(m0));
  }
}

TEST(LevelTargets, ErrorCapStopsALevel) {
  const IndexedMesh m0 = gyroid_mesh();
  const LodHierarchy hierarchy =
      lods(m0, {.levels = {{.ratio = 0.02, .error_cap = 0.02}, {.ratio = 0.019, .error_cap = kInfinity}}});
  const auto asked = static_cast<std::size_t>(0.02 * static_cast<double>(m0.triangles.size()));
  EXPECT_GT(hierarchy.levels[0].mesh.triangles.size(), 2 * asked);
  EXPECT_EQ(hierarchy.levels[0].stopped_by, StoppedBy::error_cap);
  EXPECT_LE(hierarchy.levels[1].mesh.triangles.size(), asked);
  EXPECT_EQ(hierarchy.levels[1].stopped_by, StoppedBy::none);
}

TEST(LevelTargets, DefaultCapGrowsWithTheLevel) {
  EXPECT_GT(default_error_cap(0.0625), default_error_cap(0.25));
  EXPECT_GT(default_error_cap(0.25), 0);
}

TEST(LevelTargets, MaxCostBoundsTheCost) {
  const LodHierarchy hierarchy = lods(gyroid_mesh(), {.levels = {{.max_cost = 0.01}, {.max_cost = 1}}});
  EXPECT_LE(hierarchy.levels[0].cost, 0.01);
  EXPECT_LE(hierarchy.levels[1].cost, 1);
  EXPECT_GT(hierarchy.levels[1].cost, 0.01);
  EXPECT_LT(hierarchy.levels[1].mesh.triangles.size(), hierarchy.levels[0].mesh.triangles.size());
}

TEST(LevelTargets, MaxErrorIsMeasuredAndKept) {
  const IndexedMesh m0 = mesh_field({16, 16, 16}, gyroid(12, 0.2));
  for (const WindowSizes& sizes : {WindowSizes{}, kSmallWindows}) {
    const LodHierarchy hierarchy =
        lods(m0,
             {.levels = {{.max_error = 0.9}, {.max_error = 2}},
              .measure = [](const IndexedMesh& from, const IndexedMesh& to) { return vertex_distance(to, from); }},
             sizes);
    double bound = 0.9;
    for (const LodLevel& level : hierarchy.levels) {
      EXPECT_LE(level.error, bound);
      EXPECT_EQ(level.error, vertex_distance(level.mesh, m0));
      EXPECT_LT(level.mesh.triangles.size(), m0.triangles.size() / 4);
      EXPECT_EQ(sorted_topology_of(level.mesh), sorted_topology_of(m0));
      bound = 2;
    }
  }
}

TEST(LevelTargets, MaxErrorAfterACoarserLevelBeginsAnew) {
  const IndexedMesh m0 = mesh_field({30, 30, 30}, ball({14.5, 14.5, 14.5}, 12));
  const LodHierarchy hierarchy = lods(
      m0, {.levels = {{.ratio = 0.005, .error_cap = kInfinity}, {.max_error = 0.6}}, .measure = to_nearest_vertex()});
  EXPECT_LE(hierarchy.levels[1].error, 0.6);
  EXPECT_GT(hierarchy.levels[1].mesh.triangles.size(), hierarchy.levels[0].mesh.triangles.size());
}

TEST(LevelTargets, MaxErrorAfterACoarserLevelIsMadeBeforeItInASharedArray) {
  const IndexedMesh m0 = mesh_field({30, 30, 30}, ball({14.5, 14.5, 14.5}, 12));
  const LodHierarchy hierarchy = lods(m0, {.levels = {{.ratio = 1},
                                                      {.ratio = 0.01, .error_cap = kInfinity},
                                                      {.ratio = 0.005, .error_cap = kInfinity},
                                                      {.max_error = 2},
                                                      {.ratio = 0.004, .error_cap = kInfinity}},
                                           .placement = Placement::subset,
                                           .measure = to_nearest_vertex_of_level()});
  ASSERT_EQ(hierarchy.levels.size(), 5u);
  const auto triangles = [&](std::size_t k) { return static_cast<double>(hierarchy.levels[k].mesh.triangles.size()); };
  EXPECT_LE(hierarchy.levels[3].error, 2);
  EXPECT_GT(triangles(3), triangles(1));
  EXPECT_LT(triangles(3), 0.9 * triangles(0));
  EXPECT_NEAR(triangles(1), 0.01 * triangles(0), 3);
  EXPECT_NEAR(triangles(2), 0.005 * triangles(0), 3);
  EXPECT_NEAR(triangles(4), 0.004 * triangles(0), 3);
  expect_one_vertex_array(m0, hierarchy);
}

TEST(LevelTargets, MaxErrorThatDroppedComponentsExceedKeepsTheRestInASharedArray) {
  const IndexedMesh m0 = ball_among_specks();
  const DropSpecks all_specks{.max_voxels = 2};
  const LodHierarchy hierarchy =
      lods(m0, {.levels = {{.max_error = 0.5, .drop = all_specks}, {.max_error = 0.6}, {.ratio = 0.1}},
                .placement = Placement::subset,
                .measure = to_nearest_vertex_of_level()});
  EXPECT_EQ(find_components(hierarchy.levels[0].mesh).count, 1);
  EXPECT_EQ(hierarchy.levels[0].mesh.triangles.size(), hierarchy.levels[1].mesh.triangles.size());
  expect_one_vertex_array(m0, hierarchy);
}

TEST(LevelTargets, SharedArraysCannotKeepWhatAFinerLevelDrops) {
  const IndexedMesh m0 = ball_among_specks();
  NoProgress progress;
  const auto built =
      build_lods(m0,
                 {.levels = {{.ratio = 0.005, .error_cap = kInfinity}, {.max_error = 0.01, .drop = {.max_voxels = 2}}},
                  .placement = Placement::subset,
                  .measure = to_nearest_vertex_of_level()},
                 progress);
  ASSERT_FALSE(built);
  EXPECT_EQ(built.error().code, ErrorCode::unsupported);
}

TEST(LevelTargets, RatioOneAfterAnotherLevelIsThatLevel) {
  const IndexedMesh m0 = gyroid_mesh();
  const LodHierarchy hierarchy = lods(m0, {.levels = {{.max_cost = 0.01}, {.ratio = 1}}});
  EXPECT_LT(hierarchy.levels[0].mesh.triangles.size(), m0.triangles.size());
  EXPECT_EQ(hierarchy.levels[0].mesh.triangles, hierarchy.levels[1].mesh.triangles);
}

TEST(LevelTargets, SpecksGoByVolume) {
  const IndexedMesh m0 = ball_among_specks();
  const LodHierarchy hierarchy = lods(
      m0,
      {.levels = {{.ratio = 1}, {.ratio = 0.5, .drop = {.max_voxels = 2}}, {.ratio = 0.2, .drop = {.max_voxels = 2}}}});
  EXPECT_EQ(hierarchy.levels[0].dropped_components, 0);
  EXPECT_EQ(find_components(hierarchy.levels[0].mesh).count, 19);
  for (std::size_t i : {1u, 2u}) {
    EXPECT_EQ(hierarchy.levels[i].dropped_components, 18);
    EXPECT_EQ(find_components(hierarchy.levels[i].mesh).count, 1);
    EXPECT_EQ(fault_of_shape(hierarchy.levels[i].mesh), "none");
  }
}

TEST(LevelTargets, SpecksGoByExtentFromM0OnAndInManyWindows) {
  const IndexedMesh m0 = ball_among_specks();
  for (const WindowSizes& sizes : {WindowSizes{}, kSmallWindows}) {
    const LodHierarchy hierarchy =
        lods(m0, {.levels = {{.ratio = 1, .drop = {.max_error = 2}}, {.ratio = 0.3}}}, sizes);
    EXPECT_EQ(find_components(hierarchy.levels[0].mesh).count, 1);
    EXPECT_EQ(hierarchy.levels[0].dropped_components, 18);
    EXPECT_EQ(hierarchy.levels[1].dropped_components, 18);
    for (std::size_t v = 0; v < hierarchy.levels[0].origin.size(); ++v) {
      EXPECT_EQ(hierarchy.levels[0].mesh.positions[v], m0.positions[hierarchy.levels[0].origin[v]]);
    }
  }
}

TEST(LevelTargets, OpenComponentsAreNoSpecks) {
  IndexedMesh m0;
  m0.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  m0.triangles = {{0, 1, 2}};
  EXPECT_EQ(lods(m0, {.levels = {{.ratio = 1, .drop = {100, 100}}}}).levels[0].mesh.triangles.size(), 1u);
}

TEST(LevelTargets, TheLargestSpeckStays) {
  const IndexedMesh m0 = ball_among_specks();
  const LodHierarchy hierarchy = lods(m0, {.levels = {{.ratio = 1}, {.ratio = 0.3, .drop = {1e9, 1e9}}}});
  EXPECT_EQ(find_components(hierarchy.levels[1].mesh).count, 1);
  EXPECT_EQ(hierarchy.levels[1].dropped_components, 18);
  EXPECT_GT(hierarchy.levels[1].mesh.triangles.size(), 8u);
}

TEST(LevelTargets, AmbiguousOnesAreRefused) {
  NoProgress progress;
  const IndexedMesh m0 = gyroid_mesh();
  const std::vector<std::vector<LevelTarget>> refused = {
      {{}},
      {{.ratio = 0.5, .max_cost = 1}},
      {{.max_cost = 2}, {.max_cost = 1}},
      {{.max_cost = -1}},
      {{.max_error = 1}},  // nothing to measure with
      {{.ratio = 0.5, .error_cap = -1}},
      {{.ratio = 0.5, .drop = {.max_voxels = -1}}},
      {{.ratio = 0.5, .drop = {.max_error = std::nan("")}}},
  };
  for (std::size_t i = 0; i < refused.size(); ++i) {
    const auto built = build_lods(m0, {.levels = refused[i]}, progress);
    ASSERT_FALSE(built) << i;
    EXPECT_EQ(built.error().code, ErrorCode::invalid_argument) << i;
  }
}

}  // namespace
}  // namespace geosis
