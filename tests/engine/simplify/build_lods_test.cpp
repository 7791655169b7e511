#include "engine/simplify/build_lods.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <numeric>

#include <gtest/gtest.h>

#include "engine/mesh/components.h"
#include "engine/simplify/window_sizes.h"
#include "tests/engine/simplify/field_mesh.h"
#include "tests/engine/simplify/level_checks.h"

namespace geosis {
namespace {

/// So small that meshes of a unit test have many windows and passes.
constexpr WindowSizes kSmallWindows = {.pass = 256, .last_pass = 1024, .whole_mesh = 64};

LodHierarchy lods(const IndexedMesh& m0, const BuildLodsOptions& options = {}, const WindowSizes& sizes = {}) {
  NoProgress progress;
  auto built = build_lods_in_windows(m0, options, sizes, progress);
  EXPECT_TRUE(built) << (built ? std::string() : built.error().message);
  return built ? *std::move(built) : LodHierarchy{};
}

Error refusal(const IndexedMesh& m0, const BuildLodsOptions& options = {}) {
  NoProgress progress;
  const auto built = build_lods(m0, options, progress);
  return built ? Error{ErrorCode::internal, "accepted"} : built.error();
}

std::vector<std::size_t> triangle_counts(const LodHierarchy& hierarchy) {
  std::vector<std::size_t> counts;
  for (const LodLevel& level : hierarchy.levels) counts.push_back(level.mesh.triangles.size());
  return counts;
}

bool same_bytes(const IndexedMesh& a, const IndexedMesh& b) {
  return a.positions == b.positions && a.triangles == b.triangles;
}

double distance_to_nearest_vertex(Vec3f place, const IndexedMesh& mesh) {
  double nearest = std::numeric_limits<double>::max();
  for (const Vec3f& p : mesh.positions) nearest = std::min(nearest, norm(to_double(p) - to_double(place)));
  return nearest;
}

void expect_sound_levels(const IndexedMesh& m0, const LodHierarchy& hierarchy) {
  const auto topology = sorted_topology_of(m0);
  for (std::size_t i = 0; i < hierarchy.levels.size(); ++i) {
    const IndexedMesh& mesh = hierarchy.levels[i].mesh;
    EXPECT_EQ(sorted_topology_of(mesh), topology) << "level " << i;
    EXPECT_EQ(fault_of_shape(mesh), "none") << "level " << i;
  }
}

IndexedMesh sphere() {
  return mesh_field({40, 40, 40}, ball({19.5, 19.4, 19.6}, 16));
}

/// Body between two spheres: two closed surfaces, one in the other.
IndexedMesh shell() {
  const NodeField outer = ball({14.5, 14.5, 14.5}, 12);
  const NodeField inner = ball({14.5, 14.5, 14.5}, 6);
  return mesh_field({30, 30, 30}, [=](int i, int j, int k) { return std::max(outer(i, j, k), -inner(i, j, k)); });
}

/// A flat plate cut by the grid's sides, with a round hole: open, one component, two boundary loops.
IndexedMesh plate_with_hole(int size) {
  const double middle = (size - 1) / 2.0;
  std::vector<std::int32_t> place(static_cast<std::size_t>(size) * size, -1);
  IndexedMesh mesh;
  const auto vertex = [&](int i, int j) {
    std::int32_t& v = place[static_cast<std::size_t>(i) * size + j];
    if (v < 0) {
      v = static_cast<std::int32_t>(mesh.positions.size());
      mesh.positions.push_back({static_cast<float>(i), static_cast<float>(j), 3});
    }
    return v;
  };
  for (int i = 0; i + 1 < size; ++i) {
    for (int j = 0; j + 1 < size; ++j) {
      if (std::hypot(i + 0.5 - middle, j + 0.5 - middle) < size / 5.0) continue;
      mesh.triangles.push_back({vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1)});
      mesh.triangles.push_back({vertex(i, j), vertex(i + 1, j + 1), vertex(i, j + 1)});
    }
  }
  return mesh;
}

TEST(BuildLods, ReachesTheAskedRatiosOnASphere) {
  const IndexedMesh m0 = sphere();
  for (const WindowSizes& sizes : {WindowSizes{}, kSmallWindows}) {
    const LodHierarchy hierarchy = lods(m0, {}, sizes);
    ASSERT_EQ(hierarchy.levels.size(), 5u);
    double asked = static_cast<double>(m0.triangles.size());
    for (const LodLevel& level : hierarchy.levels) {
      EXPECT_NEAR(static_cast<double>(level.mesh.triangles.size()), asked, 0.005 * asked + 2);
      EXPECT_EQ(level.stopped_by, StoppedBy::none);
      asked /= 4;
    }
    expect_sound_levels(m0, hierarchy);
  }
}

TEST(BuildLods, ReachesGentleRatiosInManyWindows) {
  const IndexedMesh m0 = sphere();
  const std::vector<double> ratios = {0.95, 0.9, 0.6, 0.5};
  const LodHierarchy hierarchy = lods(m0, {.levels = by_ratio(ratios)}, kSmallWindows);
  for (std::size_t k = 0; k < ratios.size(); ++k) {
    const double asked = ratios[k] * static_cast<double>(m0.triangles.size());
    EXPECT_NEAR(static_cast<double>(hierarchy.levels[k].mesh.triangles.size()), asked, 0.005 * asked + 2);
  }
}

TEST(BuildLods, LevelsThatAreTakenOneByOneAreTheSame) {
  const IndexedMesh m0 = shell();
  const BuildLodsOptions options{.levels = by_ratio({1, 0.5, 0.1})};
  const LodHierarchy together = lods(m0, options);
  std::size_t next = 0;
  NoProgress progress;
  const auto built = build_lods_one_by_one(m0, options, progress, [&](std::size_t k, const LodLevel& level) {
    EXPECT_EQ(k, next++);
    EXPECT_TRUE(same_bytes(k == 0 ? m0 : level.mesh, together.levels[k].mesh)) << k;
    EXPECT_EQ(level.mesh.triangles.empty(), k == 0);
  });
  EXPECT_TRUE(built);
  EXPECT_EQ(next, 3u);
}

TEST(BuildLods, LevelsThatShareVerticesComeAllAtOnce) {
  NoProgress progress;
  const auto built = build_lods_one_by_one(shell(), {.placement = Placement::subset}, progress,
                                           [](std::size_t, const LodLevel&) { FAIL(); });
  ASSERT_FALSE(built);
  EXPECT_EQ(built.error().code, ErrorCode::unsupported);
}

TEST(BuildLods, LevelOfRatioOneIsTheInput) {
  const IndexedMesh m0 = shell();
  EXPECT_TRUE(same_bytes(lods(m0, {.levels = by_ratio({1, 0.5})}).levels[0].mesh, m0));
}

TEST(BuildLods, CostNeverFalls) {
  const LodHierarchy hierarchy = lods(shell());
  EXPECT_EQ(hierarchy.levels[0].cost, 0);
  for (std::size_t i = 1; i < hierarchy.levels.size(); ++i) {
    EXPECT_GE(hierarchy.levels[i].cost, hierarchy.levels[i - 1].cost);
  }
  EXPECT_GT(hierarchy.levels.back().cost, 0);
}

TEST(BuildLods, KeepsHandlesCavitiesAndHoles) {
  for (const IndexedMesh& m0 : {shell(), mesh_field({30, 30, 14}, torus({14.5, 14.5, 6.5}, 9, 4)),
                                mesh_field({24, 24, 24}, gyroid(11, 0.2)), plate_with_hole(40)}) {
    expect_sound_levels(m0, lods(m0));
    expect_sound_levels(m0, lods(m0, {}, kSmallWindows));
  }
}

TEST(BuildLods, KeepsTheTopologyOfNoise) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const std::array<int, 3> shape{10, 9, 11};
    for (const IndexedMesh& m0 :
         {mesh_field(shape, noise(seed)), mesh_field(shape, closed_on_faces(shape, noise(seed)))}) {
      expect_sound_levels(m0, lods(m0));
      expect_sound_levels(m0, lods(m0, {}, kSmallWindows));
    }
  }
}

/// Component of m0 that each vertex of the level descends from, one for each component of the level.
std::vector<std::int32_t> components_of_origins(const LodLevel& level, const Components& of_m0) {
  const Components components = find_components(level.mesh);
  std::vector<std::int32_t> found(components.count, Components::kUnused);
  for (std::size_t v = 0; v < level.origin.size(); ++v) {
    std::int32_t& component = found[components.of_vertex[v]];
    if (component == Components::kUnused) component = of_m0.of_vertex[level.origin[v]];
    EXPECT_EQ(component, of_m0.of_vertex[level.origin[v]]) << "vertex " << v;
  }
  return found;
}

TEST(BuildLods, EachComponentDescendsFromItsOwn) {
  for (const WindowSizes& sizes : {WindowSizes{}, kSmallWindows}) {
    const std::array<int, 3> shape{20, 20, 20};
    const IndexedMesh m0 = mesh_field(shape, closed_on_faces(shape, noise(3)));
    const Components of_m0 = find_components(m0);
    const LodHierarchy hierarchy = lods(m0, {}, sizes);
    EXPECT_TRUE(hierarchy.levels[0].origin.empty());
    for (std::size_t i = 1; i < hierarchy.levels.size(); ++i) {
      ASSERT_EQ(hierarchy.levels[i].origin.size(), hierarchy.levels[i].mesh.positions.size());
      std::vector<std::int32_t> found = components_of_origins(hierarchy.levels[i], of_m0);
      std::sort(found.begin(), found.end());
      std::vector<std::int32_t> all(of_m0.count);
      std::iota(all.begin(), all.end(), 0);
      EXPECT_EQ(found, all) << "level " << i;
    }
  }
}

TEST(BuildLods, OriginsLieNearTheirVertices) {
  const IndexedMesh m0 = sphere();
  for (const WindowSizes& sizes : {WindowSizes{}, kSmallWindows}) {
    const LodLevel level = lods(m0, {.levels = by_ratio({0.25})}, sizes).levels[0];
    std::vector<std::int32_t> origins = level.origin;
    std::sort(origins.begin(), origins.end());
    EXPECT_TRUE(std::adjacent_find(origins.begin(), origins.end()) == origins.end()) << "an origin has two heirs";
    for (std::size_t v = 0; v < level.origin.size(); ++v) {
      EXPECT_LT(norm(to_double(level.mesh.positions[v] - m0.positions[level.origin[v]])), 2.0) << "vertex " << v;
    }
  }
}

TEST(BuildLods, GivesTheSameBytesForAnyNumberOfThreads) {
  const IndexedMesh m0 = mesh_field({36, 36, 36}, gyroid(13, 0.2));
  const LodHierarchy one = lods(m0, {.threads = 1}, kSmallWindows);
  for (const int threads : {2, 8}) {
    const LodHierarchy many = lods(m0, {.threads = threads}, kSmallWindows);
    for (std::size_t i = 0; i < one.levels.size(); ++i) {
      EXPECT_TRUE(same_bytes(many.levels[i].mesh, one.levels[i].mesh)) << threads << " threads, level " << i;
      EXPECT_EQ(many.levels[i].origin, one.levels[i].origin);
      EXPECT_EQ(many.levels[i].cost, one.levels[i].cost);
    }
  }
}

TEST(BuildLods, ManySmallWindowsAreNearlyAsGoodAsOne) {
  const IndexedMesh m0 = mesh_field({32, 32, 32}, gyroid(16, 0.2));
  const BuildLodsOptions options{.levels = by_ratio({0.0625})};
  const IndexedMesh one = lods(m0, options).levels[0].mesh;
  const IndexedMesh many = lods(m0, options, {.pass = 128, .last_pass = 1024, .whole_mesh = 64}).levels[0].mesh;
  EXPECT_NEAR(static_cast<double>(many.triangles.size()), static_cast<double>(one.triangles.size()), 12);
  EXPECT_LT(mean_distance(many, m0), 1.15 * mean_distance(one, m0));
}

TEST(BuildLods, CornersOfABoxStay) {
  const auto box = [](int i, int j, int k) {
    return std::max({std::abs(i - 12.0), std::abs(j - 12.0), std::abs(k - 12.0)}) - 8.5;
  };
  const IndexedMesh mesh = lods(mesh_field({25, 25, 25}, box), {.levels = by_ratio({0.02})}).levels[0].mesh;
  for (const Vec3f corner : {Vec3f{3.5f, 3.5f, 3.5f}, Vec3f{20.5f, 20.5f, 20.5f}, Vec3f{20.5f, 3.5f, 20.5f}}) {
    EXPECT_LT(distance_to_nearest_vertex(corner, mesh), 1.0);
  }
}

TEST(BuildLods, RimOfAPlateStays) {
  const IndexedMesh m0 = plate_with_hole(40);
  const IndexedMesh mesh = lods(m0, {.levels = by_ratio({0.05})}).levels[0].mesh;
  double area = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    area += norm(to_double(cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a]))) / 2;
  }
  EXPECT_NEAR(area, static_cast<double>(m0.triangles.size()) / 2, 0.02 * area);
  for (const Vec3f corner : {Vec3f{0, 0, 3}, Vec3f{39, 0, 3}, Vec3f{0, 39, 3}, Vec3f{39, 39, 3}}) {
    EXPECT_LT(distance_to_nearest_vertex(corner, mesh), 0.1);
  }
}

TEST(BuildLods, StaysInsideTheBoundingBox) {
  const IndexedMesh m0 = mesh_field({16, 16, 16}, noise(11));
  for (const LodLevel& level : lods(m0).levels) {
    for (const Vec3f& p : level.mesh.positions) {
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_GE(p[axis], 0);
        EXPECT_LE(p[axis], 15);
      }
    }
  }
}

TEST(BuildLods, TetrahedraStopAtTheirFloor) {
  IndexedMesh m0;
  for (int i = 0; i < 500; ++i) {
    const auto v = static_cast<std::int32_t>(m0.positions.size());
    const auto x = static_cast<float>(2 * i);
    m0.positions.insert(m0.positions.end(), {{x, 0, 0}, {x + 1, 0, 0}, {x, 1, 0}, {x, 0, 1}});
    m0.triangles.insert(m0.triangles.end(),
                        {{v, v + 2, v + 1}, {v, v + 1, v + 3}, {v + 1, v + 2, v + 3}, {v + 2, v, v + 3}});
  }
  for (const WindowSizes& sizes : {WindowSizes{}, kSmallWindows}) {
    const LodHierarchy hierarchy = lods(m0, {}, sizes);
    ASSERT_EQ(triangle_counts(hierarchy), (std::vector<std::size_t>(5, 2000)));
    for (std::size_t i = 1; i < 5; ++i) EXPECT_EQ(hierarchy.levels[i].stopped_by, StoppedBy::floor);
    EXPECT_EQ(hierarchy.levels[0].stopped_by, StoppedBy::none);
  }
}

TEST(BuildLods, SpecksDoNotKeepALargeBodyFromShrinking) {
  const std::array<int, 3> shape{40, 40, 40};
  const NodeField body = ball({20, 20, 20}, 12);
  const IndexedMesh m0 = mesh_field(shape, [&](int i, int j, int k) {
    const bool speck = (i % 4 == 1) && (j % 4 == 1) && (k == 2 || k == 37);
    return speck ? -0.5 : body(i, j, k);
  });
  const LodHierarchy hierarchy = lods(m0, {.levels = by_ratio({0.5})}, kSmallWindows);
  const auto asked = static_cast<double>(m0.triangles.size()) / 2;
  EXPECT_NEAR(static_cast<double>(hierarchy.levels[0].mesh.triangles.size()), asked, 0.005 * asked);
  expect_sound_levels(m0, hierarchy);
}

TEST(BuildLods, EmptyMeshHasEmptyLevels) {
  const LodHierarchy hierarchy = lods({});
  EXPECT_EQ(triangle_counts(hierarchy), std::vector<std::size_t>(5, 0));
  for (const LodLevel& level : hierarchy.levels) EXPECT_EQ(level.stopped_by, StoppedBy::none);
}

TEST(BuildLods, DropsUnusedVerticesFromSimplifiedLevels) {
  IndexedMesh m0 = sphere();
  m0.positions.push_back({1, 1, 1});
  const LodHierarchy hierarchy = lods(m0);
  EXPECT_EQ(hierarchy.levels[0].mesh.positions.size(), m0.positions.size());
  EXPECT_EQ(fault_of_shape(hierarchy.levels[1].mesh), "none");
}

TEST(BuildLods, RefusesRatiosThatDoNotFall) {
  const IndexedMesh m0 = plate_with_hole(8);
  for (const std::vector<double>& ratios :
       {std::vector<double>{}, {1, 1}, {0.5, 0.6}, {0}, {-1}, {1.5}, {std::nan("")}}) {
    EXPECT_EQ(refusal(m0, {.levels = by_ratio(ratios)}).code, ErrorCode::invalid_argument);
  }
  EXPECT_EQ(refusal(m0, {.levels = by_ratio({0.5, 0.6})}).message,
            "levels of detail: ratio 0.600000 after 0.500000; expected falling ratios");
}

TEST(BuildLods, RefusesMeshesThatAreNotManifold) {
  IndexedMesh m0 = plate_with_hole(8);
  m0.positions.push_back({0, 0, 5});
  m0.triangles.push_back({0, 1, static_cast<std::int32_t>(m0.positions.size()) - 1});
  const Error error = refusal(m0);
  EXPECT_EQ(error.code, ErrorCode::invalid_argument);
  EXPECT_NE(error.message.find("vertices 0 and 1"), std::string::npos) << error.message;
}

TEST(BuildLods, RefusesPositionsOffTheLattice) {
  for (const float x : {0.3f, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), 2e5f}) {
    IndexedMesh m0 = plate_with_hole(8);
    m0.positions[3].y = x;
    const Error error = refusal(m0);
    EXPECT_EQ(error.code, ErrorCode::invalid_argument);
    EXPECT_EQ(error.message.rfind("vertex 3: coordinate ", 0), 0u) << error.message;
  }
}

/// Cancels after so many reports.
class CancelAfter : public Progress {
 public:
  explicit CancelAfter(int reports) : left_(reports) {}
  void report(const char*, double fraction) override {
    --left_;
    in_range_ = in_range_ && fraction >= 0 && fraction <= 1;
  }
  bool cancelled() const override { return left_ <= 0; }
  bool in_range() const { return in_range_; }

 private:
  std::atomic<int> left_;
  std::atomic<bool> in_range_ = true;
};

TEST(BuildLods, StopsWhenCancelled) {
  const IndexedMesh m0 = mesh_field({36, 36, 36}, gyroid(13, 0.2));
  for (const int reports : {1, 5}) {
    for (const WindowSizes& sizes : {WindowSizes{}, kSmallWindows}) {
      CancelAfter progress(reports);
      const auto built = build_lods_in_windows(m0, {.threads = 2}, sizes, progress);
      if (sizes.pass != kSmallWindows.pass && reports > 1) continue;  // one window may be done before its fifth report
      ASSERT_FALSE(built);
      EXPECT_EQ(built.error().code, ErrorCode::cancelled);
      EXPECT_TRUE(progress.in_range());
    }
  }
}

}  // namespace
}  // namespace geosis
