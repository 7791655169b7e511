#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "engine/missing/fill.h"
#include "engine/pipeline/describe_bodies.h"
#include "engine/pipeline/reconstruct.h"
#include "engine/volume/brick_file.h"

// What of missing samples, bodies and attributes only the whole way shows.

namespace geosis {
namespace {

constexpr float kMissing = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr GridShape kShape = {40, 36, 32};

struct Ball {
  Vec3d centre;
  double radius;
};

/// The greatest of the balls' depths at each node: {f >= 0} are the balls.
float depth_in(const std::vector<Ball>& balls, Vec3d at) {
  double depth = -100;
  for (const Ball& ball : balls) depth = std::max(depth, ball.radius - norm(at - ball.centre));
  return static_cast<float>(depth);
}

/// hole   traces with |i - 19| < hole and |j - 17| < hole are missing.
std::unique_ptr<BrickedVolume> volume_of(const std::vector<Ball>& balls, int hole) {
  std::vector<float> samples;
  for (int i = 0; i < kShape.inlines; ++i) {
    for (int j = 0; j < kShape.crosslines; ++j) {
      const bool missing = std::abs(i - 19) < hole && std::abs(j - 17) < hole;
      for (int k = 0; k < kShape.samples; ++k) {
        samples.push_back(missing ? kMissing : depth_in(balls, {double(i), double(j), double(k)}));
      }
    }
  }
  return make_bricked_volume(kShape, samples);
}

const std::vector<Ball> kOne = {{{19.3, 17.6, 15.2}, 12}};
const std::vector<Ball> kThree = {{{10, 10, 10}, 6}, {{30, 26, 22}, 7}, {{30, 8, 10}, 4}};

Reconstruction reconstruct_ball(const BrickedVolume& volume, const ReconstructOptions& options) {
  NoProgress progress;
  auto result = reconstruct({volume, AffineGeometry()}, options, progress);
  EXPECT_TRUE(result) << result.error().message;
  return result ? *std::move(result) : Reconstruction{};
}

TEST(ReconstructMissing, FillingClosesTheHoleAndSaysWhereItDid) {
  const auto volume = volume_of(kOne, 3);
  const Reconstruction open = reconstruct_ball(*volume, {.range = {0, kInfinity}});
  EXPECT_EQ(open.levels[0].topology.genus, 1);  // drilled through
  EXPECT_EQ(open.levels[0].interpolated_share, 0);
  EXPECT_TRUE(open.levels[0].attributes.reliability.empty());
  for (const FillMethod method : {FillMethod::linear, FillMethod::rbf}) {
    const Reconstruction filled = reconstruct_ball(*volume, {.range = {0, kInfinity}, .fill = {.method = method}});
    EXPECT_EQ(filled.levels[0].topology.genus, 0);
    EXPECT_TRUE(filled.levels[0].topology.manifold);
    for (const ReconstructedLevel& level : filled.levels) {
      EXPECT_EQ(level.attributes.reliability.size(), level.lod.mesh.positions.size());
      EXPECT_LT(level.interpolated_share, 0.5);
    }
    EXPECT_GT(filled.levels[0].interpolated_share, 0);
    EXPECT_GT(filled.levels[1].interpolated_share, 0);
  }
}

TEST(ReconstructMissing, ReliabilityIsFullExactlyBetweenMeasuredSamples) {
  const auto volume = volume_of(kOne, 3);
  const Reconstruction filled = reconstruct_ball(
      *volume, {.range = {0, kInfinity}, .fill = {.method = FillMethod::linear}, .levels = by_ratio({1})});
  const ReconstructedLevel& finest = filled.levels[0];
  for (std::size_t v = 0; v < finest.lod.mesh.positions.size(); ++v) {
    const Vec3f p = finest.lod.mesh.positions[v];
    const bool near_hole = std::abs(p.x - 19) < 3 && std::abs(p.y - 17) < 3;
    EXPECT_EQ(finest.attributes.reliability[v] < 255, near_hole) << p.x << ", " << p.y << ", " << p.z;
  }
}

TEST(ReconstructMissing, AFillMadeBeforeGivesTheSameBytes) {
  const auto volume = volume_of(kOne, 3);
  const ReconstructOptions options{.range = {0, kInfinity}, .fill = {.method = FillMethod::rbf}};
  NoProgress progress;
  const auto filled = fill_missing(*volume, options.fill, std::nullopt, 2, progress);
  ASSERT_TRUE(filled) << filled.error().message;
  const AffineGeometry geometry;
  const auto given =
      reconstruct({.samples = *volume, .geometry = geometry, .filled = filled->get()}, options, progress);
  ASSERT_TRUE(given);
  const Reconstruction made = reconstruct_ball(*volume, options);
  for (std::size_t k = 0; k < made.levels.size(); ++k) {
    EXPECT_EQ(given->levels[k].encoded.parts[0].bytes, made.levels[k].encoded.parts[0].bytes);
  }
}

TEST(ReconstructMissing, ACompleteVolumeIsLeftAsItIs) {
  const auto volume = volume_of(kOne, 0);
  const Reconstruction plain = reconstruct_ball(*volume, {.range = {0, kInfinity}});
  const Reconstruction filled =
      reconstruct_ball(*volume, {.range = {0, kInfinity}, .fill = {.method = FillMethod::rbf}});
  EXPECT_EQ(filled.levels[0].encoded.parts[0].bytes, plain.levels[0].encoded.parts[0].bytes);
}

TEST(ReconstructBodies, HaveOneNumberOnEveryLevel) {
  const auto volume = volume_of(kThree, 0);
  const Reconstruction result = reconstruct_ball(*volume, {.range = {0, kInfinity}, .attributes = {.body = true}});
  for (const ReconstructedLevel& level : result.levels) {
    ASSERT_EQ(level.attributes.body.size(), level.lod.mesh.positions.size());
    for (std::size_t v = 0; v < level.attributes.body.size(); ++v) {
      const Vec3f p = level.lod.mesh.positions[v];
      const std::uint32_t expected = p.x < 20 ? 1 : p.y > 16 ? 0 : 2;  // by falling size
      EXPECT_EQ(level.attributes.body[v], expected);
    }
  }
}

TEST(ReconstructBodies, AreKeptAsTheChoiceSays) {
  const auto volume = volume_of(kThree, 0);
  const auto components = [&](const BodyChoice& choice) {
    const Reconstruction result =
        reconstruct_ball(*volume, {.range = {0, kInfinity}, .bodies = choice, .levels = by_ratio({1})});
    return result.levels.empty() ? 0 : result.levels[0].topology.components;
  };
  EXPECT_EQ(components({}), 3);
  EXPECT_EQ(components({.largest = 2}), 2);
  EXPECT_EQ(components({.min_voxels = 500}), 2);
  EXPECT_EQ(components({.seeds = {{30, 8, 10}}}), 1);
  EXPECT_EQ(components({.seeds = {{0, 0, 0}}}), 0);
  EXPECT_EQ(components({.seeds = {{30, 8, 10}, {10, 10, 10}}, .largest = 1}), 1);
}

TEST(DescribeBodies, TellsWhatEachIsInTheSpaceAskedFor) {
  const auto volume = volume_of(kThree, 0);
  const AffineGeometry geometry({1000, 2000, 0}, {25, 0, 0}, {0, 25, 0}, {0, 0, 4});
  NoProgress progress;
  const auto bodies = describe_bodies({*volume, geometry}, {.range = {0, kInfinity}}, progress);
  ASSERT_TRUE(bodies) << bodies.error().message;
  ASSERT_EQ(bodies->size(), 3u);
  const DescribedBody& largest = bodies->front();
  EXPECT_NEAR(largest.surface.volume_voxels, 4.0 / 3 * 3.14159 * 343, 40);
  EXPECT_NEAR(largest.surface.volume, largest.surface.volume_voxels * 2500, 1e-6 * largest.surface.volume);
  EXPECT_NEAR(largest.surface.centroid.x, 1000 + 25 * 30, 2);
  EXPECT_NEAR(largest.surface.centroid.z, 4 * 22, 0.5);
  EXPECT_EQ(largest.surface.genus, 0);
  ASSERT_TRUE(largest.samples.amplitude);
  EXPECT_EQ(largest.samples.amplitude->max, 7);
  EXPECT_GE(largest.samples.amplitude->min, 0);
}

TEST(ReconstructValues, AreThoseOfTheOtherVolumeAtEveryVertex) {
  const auto volume = volume_of(kOne, 0);
  std::vector<float> ramp;
  for (int i = 0; i < kShape.inlines; ++i) {
    for (int j = 0; j < kShape.crosslines; ++j) {
      for (int k = 0; k < kShape.samples; ++k) ramp.push_back(static_cast<float>(i + 2 * j + 4 * k));
    }
  }
  const auto other = make_bricked_volume(kShape, ramp);
  const AffineGeometry geometry;
  NoProgress progress;
  const ReconstructOptions options{.range = {0, kInfinity}, .attributes = {.value = true}, .attribute_volume = "id"};
  const auto result =
      reconstruct({.samples = *volume, .geometry = geometry, .attribute_volume = other.get()}, options, progress);
  ASSERT_TRUE(result) << result.error().message;
  for (const ReconstructedLevel& level : result->levels) {
    for (std::size_t v = 0; v < level.lod.mesh.positions.size(); ++v) {
      const Vec3f p = level.lod.mesh.positions[v];
      EXPECT_FLOAT_EQ(level.attributes.value[v], p.x + 2 * p.y + 4 * p.z);
    }
  }
  EXPECT_EQ(reconstruct({*volume, geometry}, options, progress).error().code, ErrorCode::invalid_argument);
}

TEST(ReconstructNormals, PointOutOfABallAtEveryLevel) {
  const auto volume = volume_of(kOne, 0);
  for (const double side : {1.0, -1.0}) {  // -1: the world is mirrored
    const AffineGeometry geometry({0, 0, 0}, {side, 0, 0}, {0, 1, 0}, {0, 0, 1});
    NoProgress progress;
    const auto result = reconstruct({*volume, geometry}, {.range = {0, kInfinity}, .normals = true}, progress);
    ASSERT_TRUE(result) << result.error().message;
    for (const ReconstructedLevel& level : result->levels) {
      ASSERT_EQ(level.attributes.normal.size(), level.lod.mesh.positions.size());
      for (std::size_t v = 0; v < level.attributes.normal.size(); ++v) {
        const Vec3d n = to_double(level.attributes.normal[v]);
        const Vec3d out = to_double(level.lod.mesh.positions[v]) - kOne[0].centre;
        EXPECT_NEAR(norm(n), 1, 1e-6);
        EXPECT_GT(dot(n, out) / norm(out), 0.95);
      }
    }
  }
}

TEST(ReconstructNormals, FollowTheCapWhereTheBodyIsCut) {
  const auto volume = volume_of(kOne, 0);
  NoProgress progress;
  const ReconstructOptions options{
      .range = {0, kInfinity}, .region = GridBox{{0, 0, 0}, {19, 35, 31}}, .levels = by_ratio({1}), .normals = true};
  const auto result = reconstruct({*volume, AffineGeometry()}, options, progress);
  ASSERT_TRUE(result) << result.error().message;
  const ReconstructedLevel& finest = result->levels[0];
  for (std::size_t v = 0; v < finest.lod.mesh.positions.size(); ++v) {
    const Vec3f p = finest.lod.mesh.positions[v];
    const double from_axis = std::hypot(p.y - 17.6, p.z - 15.2);
    if (p.x < 19 || from_axis < 2 || from_axis > 9) continue;  // the field has a tip in the middle of the ball
    EXPECT_GT(finest.attributes.normal[v].x, 0.99);
  }
}

}  // namespace
}  // namespace geosis
