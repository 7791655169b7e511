#include "engine/pipeline/reconstruct.h"

#include <atomic>
#include <limits>
#include <memory>
#include <numbers>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

#include "engine/volume/brick_file.h"

namespace geosis {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr double kRadius = 12;
constexpr GridShape kShape = {40, 36, 32};

/// Samples fall with the distance from the center of a ball: {f >= 0} is the ball.
std::unique_ptr<BrickedVolume> ball() {
  std::vector<float> samples;
  for (int i = 0; i < kShape.inlines; ++i) {
    for (int j = 0; j < kShape.crosslines; ++j) {
      for (int k = 0; k < kShape.samples; ++k) {
        samples.push_back(static_cast<float>(kRadius - norm(Vec3d{i - 19.3, j - 17.6, k - 15.2})));
      }
    }
  }
  return make_bricked_volume(kShape, samples);
}

const ReconstructOptions kBall = {.range = {0, kInfinity}, .levels = by_ratio({1, 0.25, 0.0625})};

Reconstruction reconstruct_ball(const ReconstructOptions& options, const GridGeometry& geometry = AffineGeometry()) {
  NoProgress progress;
  auto result = reconstruct({*ball(), geometry}, options, progress);
  EXPECT_TRUE(result) << result.error().message;
  return result ? *std::move(result) : Reconstruction{};
}

Error error_of(const ReconstructOptions& options, const GridGeometry& geometry = AffineGeometry()) {
  NoProgress progress;
  const auto result = reconstruct({*ball(), geometry}, options, progress);
  EXPECT_FALSE(result);
  return result ? Error{} : result.error();
}

std::int64_t triangles_of(const EncodedLevel& level) {
  std::int64_t triangles = 0;
  for (const EncodedPart& part : level.parts) triangles += part.triangles;
  return triangles;
}

constexpr double kBallVolume = 4.0 / 3 * std::numbers::pi * kRadius * kRadius * kRadius;

TEST(Reconstruct, EveryLevelIsACertifiedBall) {
  const Reconstruction result = reconstruct_ball(kBall);
  ASSERT_EQ(result.levels.size(), 3u);
  for (const ReconstructedLevel& level : result.levels) {
    EXPECT_TRUE(level.topology.manifold);
    EXPECT_EQ(level.topology.components, 1);
    EXPECT_EQ(level.topology.euler, 2);
    EXPECT_EQ(level.topology.boundary_loops, 0);
    EXPECT_EQ(level.topology.triangles, static_cast<std::int64_t>(level.lod.mesh.triangles.size()));
    EXPECT_EQ(triangles_of(level.encoded), level.topology.triangles);
    EXPECT_NEAR(level.measures.volume, kBallVolume, 0.05 * kBallVolume);
    EXPECT_LT(level.distance.max_voxels, 2);
  }
  EXPECT_GT(result.levels[0].topology.triangles, 2 * result.levels[1].topology.triangles);
  EXPECT_GT(result.levels[1].topology.triangles, 2 * result.levels[2].topology.triangles);
}

TEST(Reconstruct, DistanceAndDriftGrowFromZeroAtLevel0) {
  const Reconstruction result = reconstruct_ball(kBall);
  EXPECT_EQ(result.levels[0].distance.max_voxels, 0);
  EXPECT_EQ(result.levels[0].distance.samples, 0);
  EXPECT_EQ(result.levels[0].volume_drift, 0);
  EXPECT_GT(result.levels[1].distance.mean_voxels, 0);
  EXPECT_GT(result.levels[2].distance.mean_voxels, result.levels[1].distance.mean_voxels);
  const double volume = result.levels[0].measures.volume;
  EXPECT_NEAR(result.levels[2].volume_drift, result.levels[2].measures.volume / volume - 1, 1e-12);
}

TEST(Reconstruct, DistanceIsToM0EvenWhenNobodyAsksForIt) {
  ReconstructOptions options = kBall;
  const Reconstruction all = reconstruct_ball(options);
  options.levels = by_ratio({0.25, 0.0625});
  const Reconstruction coarse = reconstruct_ball(options);
  ASSERT_EQ(coarse.levels.size(), 2u);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(coarse.levels[k].encoded.parts[0].bytes, all.levels[k + 1].encoded.parts[0].bytes);
    EXPECT_EQ(coarse.levels[k].distance.mean_voxels, all.levels[k + 1].distance.mean_voxels);
    EXPECT_NEAR(coarse.levels[k].volume_drift, all.levels[k + 1].volume_drift, 1e-12);
  }
}

TEST(Reconstruct, NothingInTheRangeHasNoLevels) {
  ReconstructOptions options = kBall;
  options.range = {1000, kInfinity};
  const Reconstruction result = reconstruct_ball(options);
  EXPECT_TRUE(result.levels.empty());
  EXPECT_EQ(result.empty, EmptyReason::nothing_in_range);
  EXPECT_EQ(reconstruct_ball(kBall).empty, std::nullopt);
}

TEST(Reconstruct, SaysWhichFilterLeavesNoBody) {
  ReconstructOptions options = kBall;
  options.bodies = {.seeds = {{0, 0, 0}}};
  EXPECT_EQ(reconstruct_ball(options).empty, EmptyReason::no_seeded_body);
  options.bodies = {.min_voxels = 2 * kBallVolume};
  EXPECT_EQ(reconstruct_ball(options).empty, EmptyReason::too_small);
  options.bodies = {.seeds = {{19, 17, 15}}, .min_voxels = 2 * kBallVolume};
  EXPECT_EQ(reconstruct_ball(options).empty, EmptyReason::too_small);
  options.range = {1000, kInfinity};
  EXPECT_EQ(reconstruct_ball(options).empty, EmptyReason::nothing_in_range);
}

TEST(Reconstruct, WithoutACapABodyThatFillsTheRegionHasNoSurface) {
  ReconstructOptions options = kBall;
  options.cap = false;
  options.region = GridBox{{17, 15, 13}, {21, 19, 17}};
  EXPECT_EQ(reconstruct_ball(options).empty, EmptyReason::no_surface);
  options.bodies = {.seeds = {{19, 17, 15}}};
  EXPECT_EQ(reconstruct_ball(options).empty, EmptyReason::no_surface);
}

TEST(Reconstruct, MeasuresAreInWorldUnitsAndOutwardsAlsoWhenMirrored) {
  const AffineGeometry right({1e6, 2e6, 0}, {25, 0, 0}, {0, 12.5, 0}, {0, 0, 4});
  const AffineGeometry mirrored({1e6, 2e6, 0}, {0, 25, 0}, {12.5, 0, 0}, {0, 0, 4});
  ASSERT_TRUE(mirrored.mirrored());
  for (const AffineGeometry& geometry : {right, mirrored}) {
    const Reconstruction result = reconstruct_ball(kBall, geometry);
    EXPECT_NEAR(result.levels[0].measures.volume, 25 * 12.5 * 4 * kBallVolume, 0.02 * 25 * 12.5 * 4 * kBallVolume);
  }
}

TEST(Reconstruct, IndexSpaceIgnoresTheGeometry) {
  ReconstructOptions options = kBall;
  options.index_space = true;
  const AffineGeometry mirrored({1e6, 2e6, 0}, {0, 25, 0}, {12.5, 0, 0}, {0, 0, 4});
  const Reconstruction there = reconstruct_ball(options, mirrored), here = reconstruct_ball(kBall);
  EXPECT_EQ(there.levels[0].encoded.parts[0].bytes, here.levels[0].encoded.parts[0].bytes);
  EXPECT_EQ(there.levels[0].measures.volume, here.levels[0].measures.volume);
}

TEST(Reconstruct, RegionCutsTheBody) {
  ReconstructOptions options = kBall;
  options.region = GridBox{{0, 0, 0}, {19, 35, 31}};
  const Reconstruction result = reconstruct_ball(options);
  EXPECT_TRUE(result.levels[0].topology.manifold);
  EXPECT_EQ(result.levels[0].topology.euler, 2);
  EXPECT_NEAR(result.levels[0].measures.volume, kBallVolume / 2, 0.05 * kBallVolume);
}

void expect_same(const Reconstruction& a, const Reconstruction& b) {
  ASSERT_EQ(a.levels.size(), b.levels.size());
  for (std::size_t k = 0; k < a.levels.size(); ++k) {
    EXPECT_EQ(a.levels[k].encoded.parts[0].bytes, b.levels[k].encoded.parts[0].bytes);
    EXPECT_EQ(a.levels[k].distance.mean_voxels, b.levels[k].distance.mean_voxels);
    EXPECT_EQ(a.levels[k].distance.max_voxels, b.levels[k].distance.max_voxels);
    EXPECT_EQ(a.levels[k].space_distance->mean, b.levels[k].space_distance->mean);
    EXPECT_EQ(a.levels[k].volume_drift, b.levels[k].volume_drift);
    EXPECT_EQ(a.levels[k].measures.area, b.levels[k].measures.area);
    EXPECT_EQ(a.levels[k].topology.vertices, b.levels[k].topology.vertices);
  }
}

const AffineGeometry kStretched({7, 8, 9}, {2, 0, 0}, {0, 1, 0}, {0, 0, 3});

TEST(Reconstruct, AnyNumberOfThreadsMakesTheSameBytes) {
  ReconstructOptions options = kBall;
  options.normals = true;
  for (const auto& levels : {kBall.levels, by_ratio({0.5}), {{.max_error = 0.3}, {.max_error = 1.0}}}) {
    for (const Placement placement : {Placement::optimal, Placement::subset}) {
      options.levels = levels;
      options.placement = placement;
      options.threads = 1;
      const Reconstruction serial = reconstruct_ball(options, kStretched);
      for (const int threads : {2, 8}) {
        options.threads = threads;
        expect_same(serial, reconstruct_ball(options, kStretched));
      }
    }
  }
}

TEST(Reconstruct, TellsOfEachLevelCoarsestFirst) {
  for (const int threads : {1, 2, 4}) {
    NoProgress progress;
    std::vector<std::size_t> told;
    StageTimings timings;
    ReconstructOptions options = kBall;
    options.threads = threads;
    const auto result =
        reconstruct({*ball(), AffineGeometry()}, options, progress, &timings,
                    [&](std::size_t level, const ReconstructedLevel& made) {
                      told.push_back(level);
                      EXPECT_EQ(triangles_of(made.encoded), static_cast<std::int64_t>(made.lod.mesh.triangles.size()));
                      EXPECT_EQ(made.topology.euler, 2);
                      EXPECT_GT(made.measures.area, 0);
                    });
    ASSERT_TRUE(result);
    EXPECT_EQ(told, (std::vector<std::size_t>{2, 1, 0}));
    for (const double seconds : {timings.extract, timings.simplify, timings.encode, timings.certify}) {
      EXPECT_GT(seconds, 0);
    }
  }
}

TEST(Reconstruct, RefusesPositionBitsThatCannotHoldTheVolume) {
  ReconstructOptions options = kBall;
  for (const int bits : {11, 24}) {  // 40 samples need 12
    options.position_bits = bits;
    const Error error = error_of(options);
    EXPECT_EQ(error.code, ErrorCode::invalid_argument);
    EXPECT_EQ(error.message, "position bits " + std::to_string(bits) + "; this volume needs 12..23");
  }
  options.position_bits = 12;
  EXPECT_EQ(reconstruct_ball(options).levels.size(), 3u);
}

TEST(Reconstruct, PassesOnWhatTheStagesRefuse) {
  ReconstructOptions options = kBall;
  options.range = {2, 1};
  EXPECT_EQ(error_of(options).code, ErrorCode::invalid_argument);
  options = kBall;
  options.levels = by_ratio({1, 2});
  EXPECT_EQ(error_of(options).code, ErrorCode::invalid_argument);
  for (const int threads : {1, 2}) {  // with two, encoding fails beside the simplification
    options = kBall;
    options.speed = 11;
    options.threads = threads;
    EXPECT_EQ(error_of(options).code, ErrorCode::invalid_argument);
  }
}

class Bent final : public GridGeometry {
 public:
  Vec3d map(Vec3d p) const override { return {p.x, p.y, p.z + p.x * p.x}; }
  const std::array<double, 16>* affine() const override { return nullptr; }
  bool mirrored() const override { return false; }
};

TEST(Reconstruct, CurvedGeometriesHaveALatticeOfTheirOwn) {
  ReconstructOptions options = kBall;
  const Reconstruction world = reconstruct_ball(options, Bent());
  ASSERT_EQ(world.levels.size(), 3u);
  EXPECT_GT(world.levels[0].measures.volume, 0);
  options.index_space = true;
  const Reconstruction index = reconstruct_ball(options, Bent());
  ASSERT_EQ(index.levels.size(), 3u);
  EXPECT_EQ(world.levels[0].topology.euler, index.levels[0].topology.euler);
}

/// Cancels as soon as the given stage reports.
class CancelAt final : public Progress {
 public:
  explicit CancelAt(std::string_view stage) : stage_(stage) {}
  void report(const char* stage, double) override { cancelled_ = cancelled_ || stage_ == stage; }
  bool cancelled() const override { return cancelled_; }

 private:
  std::string_view stage_;
  std::atomic<bool> cancelled_ = false;
};

TEST(Reconstruct, StopsAtEveryStage) {
  for (const std::string_view stage : {"extract", "simplify", "encode", "certify"}) {
    for (const int threads : {1, 2, 4}) {
      CancelAt progress(stage);
      ReconstructOptions options = kBall;
      options.threads = threads;
      const auto result = reconstruct({*ball(), AffineGeometry()}, options, progress);
      ASSERT_FALSE(result) << stage;
      EXPECT_EQ(result.error().code, ErrorCode::cancelled) << stage;
    }
  }
}

}  // namespace
}  // namespace geosis
