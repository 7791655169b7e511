#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/pipeline/describe_bodies.h"
#include "engine/pipeline/grid_stage.h"
#include "engine/pipeline/reconstruct.h"
#include "engine/volume/brick_file.h"
#include "tests/support/layered_truth.h"
#include "tests/support/mesh_checks.h"
#include "tests/support/random.h"
#include "tests/support/thin_layer.h"

// Surfaces on structural grids, the whole way.

namespace geosis {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kMissing = std::numeric_limits<float>::quiet_NaN();

Reconstruction run(const BrickedVolume& volume, const ReconstructOptions& options,
                   const GridGeometry& geometry = AffineGeometry()) {
  NoProgress progress;
  auto result = reconstruct({volume, geometry}, options, progress);
  EXPECT_TRUE(result) << result.error().message;
  return result ? *std::move(result) : Reconstruction{};
}

std::vector<DescribedBody> bodies_of(const BrickedVolume& volume, const ReconstructOptions& options) {
  NoProgress progress;
  auto bodies = describe_bodies({volume, AffineGeometry()}, options, progress);
  EXPECT_TRUE(bodies) << bodies.error().message;
  return bodies ? *std::move(bodies) : std::vector<DescribedBody>{};
}

/// Noisy reflectors, some samples missing.
test::ScalarField rough_field(GridShape shape, double missing, std::uint64_t seed) {
  auto field =
      test::LayeredTruth({.shape = shape, .layering = test::Layering::steep, .noise = 0.5, .seed = seed}).samples();
  test::Random random(seed);
  for (float& sample : field.samples) {
    if (random.unit() < missing) sample = kMissing;
  }
  return field;
}

TEST(StructuralSurface, JoinsAThinSteepLayerThatTheAxisGridTearsApart) {
  const test::ThinLayer layer{.shape = {40, 40, 100}, .dip = 3, .thickness = 2};
  const auto field = test::samples_of(layer);
  const auto volume = make_bricked_volume(field.shape, field.samples);
  ReconstructOptions options{.range = {test::kThinLayerLevel, kInfinity}, .levels = by_ratio({1, 0.25, 0.0625})};
  const Reconstruction axis = run(*volume, options);
  options.grid = GridChoice::automatic;
  const Reconstruction structural = run(*volume, options);
  EXPECT_FALSE(axis.grid);
  ASSERT_TRUE(structural.grid && structural.grid->structure);
  EXPECT_GT(axis.levels[0].topology.components, 500);
  EXPECT_EQ(structural.levels[0].topology.components, 1);
  EXPECT_GT(test::fit_of(layer, axis.levels[0].lod.mesh).normal_degrees, 30);
  EXPECT_LT(test::fit_of(layer, structural.levels[0].lod.mesh).normal_degrees, 4.4);  // 1.5 x 2.9
  EXPECT_LT(test::fit_of(layer, structural.levels[0].lod.mesh).error, 0.1);
  for (const ReconstructedLevel& level : structural.levels) {
    EXPECT_TRUE(level.topology.manifold);
    EXPECT_EQ(level.topology.boundary_loops, 0);
    EXPECT_EQ(level.topology.euler, structural.levels[0].topology.euler);
    EXPECT_EQ(level.lod.stopped_by, StoppedBy::none);
  }
}

/// Vertices on traces: inline and crossline whole, sample not.
std::set<std::array<float, 3>> crossings_on_traces(const IndexedMesh& mesh) {
  std::set<std::array<float, 3>> crossings;
  for (const Vec3f& p : mesh.positions) {
    if (p.x == std::floor(p.x) && p.y == std::floor(p.y) && p.z != std::floor(p.z)) crossings.insert({p.x, p.y, p.z});
  }
  return crossings;
}

TEST(StructuralSurface, CrossesTracesWhereTheAxisGridDoes) {
  const std::uint64_t seed = test::test_seed(41);
  SCOPED_TRACE("seed " + std::to_string(seed));
  const auto field = rough_field({30, 33, 80}, 0, seed);
  const auto volume = make_bricked_volume(field.shape, field.samples);
  ReconstructOptions options{.range = {0.4f, 1.5f}, .levels = by_ratio({1})};
  const auto axis = crossings_on_traces(run(*volume, options).levels[0].lod.mesh);
  options.grid = GridChoice::structural;
  const auto structural = crossings_on_traces(run(*volume, options).levels[0].lod.mesh);
  EXPECT_GT(axis.size(), 1000u);
  EXPECT_EQ(axis, structural);
}

TEST(StructuralSurface, OfRoughFieldsIsClosedAndKeepsItsTopologyOnAllLevels) {
  const std::uint64_t seed = test::test_seed(42);
  for (int round = 0; round < 6; ++round) {
    SCOPED_TRACE("seed " + std::to_string(seed) + " round " + std::to_string(round));
    const auto field = rough_field({26, 24, 60}, round % 2 == 0 ? 0.0 : 0.02, seed + static_cast<std::uint64_t>(round));
    const auto volume = make_bricked_volume(field.shape, field.samples);
    ReconstructOptions options{.range = {0.3f, round < 3 ? kInfinity : 1.2f},
                               .grid = GridChoice::structural,
                               .levels = by_ratio({1, 0.25, 0.0625}),
                               .attributes = {.body = true},
                               .normals = true};
    options.index_space = round == 4;
    if (round == 2) options.region = GridBox{{3, 4, 10}, {20, 22, 47}};
    const Reconstruction result = run(*volume, options);
    ASSERT_EQ(result.levels.size(), 3u);
    const test::MeshCensus m0 = test::census(result.levels[0].lod.mesh);
    EXPECT_TRUE(m0.is_closed_manifold()) << m0;
    EXPECT_GT(m0.volume, 0);
    for (const ReconstructedLevel& level : result.levels) {
      EXPECT_TRUE(level.topology.manifold);
      EXPECT_EQ(level.topology.components, m0.components);
      EXPECT_EQ(level.topology.euler, m0.euler());
      EXPECT_EQ(level.topology.boundary_loops, 0);
      EXPECT_NEAR(level.measures.volume, m0.volume, 0.05 * m0.volume);
    }
    EXPECT_LT(result.levels[1].topology.triangles, result.levels[0].topology.triangles / 2);
  }
}

TEST(StructuralSurface, IsTheSameForAnyNumberOfThreads) {
  const auto field = rough_field({30, 33, 80}, 0.01, 7);
  const auto volume = make_bricked_volume(field.shape, field.samples);
  ReconstructOptions options{.range = {0.4f, kInfinity},
                             .grid = GridChoice::structural,
                             .levels = by_ratio({1, 0.25}),
                             .attributes = {.body = true}};
  const Reconstruction one = run(*volume, options);
  options.threads = 3;
  const Reconstruction three = run(*volume, options);
  for (std::size_t k = 0; k < 2; ++k) {
    ASSERT_EQ(one.levels[k].encoded.parts.size(), three.levels[k].encoded.parts.size());
    for (std::size_t p = 0; p < one.levels[k].encoded.parts.size(); ++p) {
      EXPECT_EQ(one.levels[k].encoded.parts[p].bytes, three.levels[k].encoded.parts[p].bytes);
    }
  }
}

TEST(StructuralSurface, CountsEverySampleOfItsBodiesOnce) {
  const auto field = rough_field({26, 24, 100}, 0, 9);
  const auto volume = make_bricked_volume(field.shape, field.samples);
  for (const bool index_space : {false, true}) {
    ReconstructOptions options{.range = {0.3f, kInfinity}, .grid = GridChoice::structural, .index_space = index_space};
    const auto bodies = bodies_of(*volume, options);
    std::int64_t voxels = 0, in_range = 0;
    double sum = 0, sum_in_range = 0;
    for (const DescribedBody& body : bodies) {
      voxels += body.samples.voxels;
      if (body.samples.amplitude) sum += body.samples.amplitude->mean * static_cast<double>(body.samples.voxels);
    }
    for (const float sample : field.samples) {
      if (!(sample >= 0.3f)) continue;
      ++in_range;
      sum_in_range += sample;
    }
    EXPECT_EQ(voxels, in_range);
    EXPECT_NEAR(sum, sum_in_range, 1e-6 * sum_in_range);
    if (index_space) continue;
    for (std::size_t b = 1; b < bodies.size(); ++b) {
      EXPECT_GE(bodies[b - 1].surface.volume_voxels, bodies[b].surface.volume_voxels);
    }
  }
}

TEST(StructuralSurface, KeepsTheBodyOfASeed) {
  const auto field = rough_field({26, 24, 60}, 0, 9);
  const auto volume = make_bricked_volume(field.shape, field.samples);
  const ReconstructOptions all{.range = {0.3f, kInfinity}, .grid = GridChoice::structural};
  GridIndex seed;
  test::for_each_node(field.shape, [&](GridIndex n) {
    if (n.i == 12 && n.j == 12 && field.at(n) >= 0.3f) seed = n;
  });
  ReconstructOptions seeded = all;
  seeded.bodies.seeds = {seed};
  EXPECT_GT(bodies_of(*volume, all).size(), 1u);
  const auto kept = bodies_of(*volume, seeded);
  ASSERT_EQ(kept.size(), 1u);
  EXPECT_GT(kept[0].samples.voxels, 0);
}

TEST(StructuralSurface, LooksOutwardsAndHasOneVolumeInEveryWorld) {
  const auto field = rough_field({20, 22, 50}, 0, 3);
  const auto volume = make_bricked_volume(field.shape, field.samples);
  const ReconstructOptions options{
      .range = {0.4f, kInfinity}, .grid = GridChoice::structural, .levels = by_ratio({1, 0.25})};
  const double plain = run(*volume, options).levels[0].measures.volume;
  const AffineGeometry right({1e6, 2e6, 0}, {25, 0, 0}, {0, 12.5, 0}, {0, 0, 4});
  const AffineGeometry mirrored({1e6, 2e6, 0}, {0, 25, 0}, {12.5, 0, 0}, {0, 0, 4});
  for (const AffineGeometry& geometry : {right, mirrored}) {
    const Reconstruction result = run(*volume, options, geometry);
    EXPECT_NEAR(result.levels[0].measures.volume, plain * 25 * 12.5 * 4, 1e-6 * plain * 1250);
    EXPECT_NEAR(result.levels[1].measures.volume, plain * 25 * 12.5 * 4, 0.02 * plain * 1250);
  }
}

TEST(StructuralSurface, TellsHowWellTracesAgreeAtItsVertices) {
  const test::LayeredTruth truth({.shape = {40, 40, 80}, .layering = test::Layering::faulted});
  const auto field = truth.samples();
  const auto volume = make_bricked_volume(field.shape, field.samples);
  ReconstructOptions options{.range = {0.4f, kInfinity},
                             .grid = GridChoice::structural,
                             .levels = by_ratio({1, 0.25}),
                             .attributes = {.agreement = true}};
  for (const bool index_space : {false, true}) {
    options.index_space = index_space;
    const Reconstruction result = run(*volume, options);
    for (const ReconstructedLevel& level : result.levels) {
      const auto& agreement = level.attributes.agreement;
      ASSERT_EQ(agreement.size(), level.lod.mesh.positions.size());
      EXPECT_LT(*std::min_element(agreement.begin(), agreement.end()), 200);
      double sum = 0;
      for (const std::uint8_t a : agreement) sum += a;
      EXPECT_GT(sum / static_cast<double>(agreement.size()), 215);
      std::vector<std::span<const std::byte>> parts;
      for (const EncodedPart& part : level.encoded.parts) parts.emplace_back(part.bytes);
      const auto decoded = decode_level(parts);
      ASSERT_TRUE(decoded);
      EXPECT_EQ(decoded->attributes.agreement.size(), decoded->mesh.positions.size());
    }
  }
  options.grid = GridChoice::given;
  EXPECT_TRUE(run(*volume, options).levels[0].attributes.agreement.empty());
}

TEST(AutomaticGrid, LooksAtDipsAndPeriod) {
  EXPECT_FALSE(prefers_structure({}));
  EXPECT_FALSE(prefers_structure({.period = 16, .dips = {DipQuantiles{0, 1.9, 3}, DipQuantiles{0, 0.1, 1}}}));
  EXPECT_TRUE(prefers_structure({.period = 16, .dips = {DipQuantiles{0, 0.1, 1}, DipQuantiles{0, 2.1, 3}}}));
}

TEST(AutomaticGrid, LeavesFlatReflectorsAsTheyAre) {
  const auto field =
      test::LayeredTruth({.shape = {20, 20, 60}, .layering = test::Layering::plane, .dip = 0.3}).samples();
  const auto volume = make_bricked_volume(field.shape, field.samples);
  ReconstructOptions options{.range = {0.4f, kInfinity}, .levels = by_ratio({1})};
  const Reconstruction given = run(*volume, options);
  options.grid = GridChoice::automatic;
  const Reconstruction chosen = run(*volume, options);
  ASSERT_TRUE(chosen.grid);
  EXPECT_FALSE(chosen.grid->structure);
  EXPECT_EQ(chosen.levels[0].encoded.parts[0].bytes, given.levels[0].encoded.parts[0].bytes);
}

}  // namespace
}  // namespace geosis
