#include "engine/pipeline/preview.h"

#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "engine/volume/brick_file.h"

namespace geosis {
namespace {

constexpr GridShape kShape = {161, 150, 170};
constexpr double kRadius = 50;
constexpr Vec3d kCenter = {78.3, 70.6, 80.2};
constexpr double kVolume = 4.0 / 3 * std::numbers::pi * kRadius * kRadius * kRadius;

/// Samples fall with the distance from the center of a ball, and a speck of eight samples lies in a corner.
const BrickedVolume& ball() {
  static const std::unique_ptr<BrickedVolume> volume = [] {
    std::vector<float> samples;
    for (int i = 0; i < kShape.inlines; ++i) {
      for (int j = 0; j < kShape.crosslines; ++j) {
        for (int k = 0; k < kShape.samples; ++k) {
          const bool is_speck = (i == 8 || i == 9) && (j == 8 || j == 9) && (k == 8 || k == 9);
          samples.push_back(is_speck ? 5
                                     : static_cast<float>(kRadius - norm(Vec3d{i + 0.0, j + 0.0, k + 0.0} - kCenter)));
        }
      }
    }
    return make_bricked_volume(kShape, samples);
  }();
  return *volume;
}

ReconstructOptions preview_of_ball() {
  return preview_options(
      {.range = {0, std::numeric_limits<float>::infinity()}, .bodies = {.min_voxels = 100}, .threads = 2});
}

Reconstruction look(const ReconstructOptions& options, const GridGeometry& geometry = AffineGeometry()) {
  NoProgress progress;
  auto result = reconstruct({ball(), geometry}, options, progress);
  EXPECT_TRUE(result) << result.error().message;
  return result ? *std::move(result) : Reconstruction{};
}

/// Positions of the only level, in the result's space.
std::vector<Vec3d> places(const Reconstruction& result) {
  const auto& m = result.transform;
  std::vector<Vec3d> places;
  for (const Vec3f p : result.levels.at(0).lod.mesh.positions) {
    places.push_back({m[0] * p.x + m[1] * p.y + m[2] * p.z + m[3], m[4] * p.x + m[5] * p.y + m[6] * p.z + m[7],
                      m[8] * p.x + m[9] * p.y + m[10] * p.z + m[11]});
  }
  return places;
}

double farthest_from_ball(const std::vector<Vec3d>& places, Vec3d center, double radius) {
  double farthest = 0;
  for (const Vec3d p : places) farthest = std::max(farthest, std::fabs(norm(p - center) - radius));
  return farthest;
}

TEST(Preview, ReadsMoreSamplesThanTracesAndNeverTooMany) {
  EXPECT_EQ(preview_step(whole({100, 100, 100}), 100'000), (GridIndex{1, 1, 1}));
  EXPECT_EQ(preview_step(whole(kShape), 100'000), (GridIndex{2, 2, 1}));
  EXPECT_EQ(preview_step(whole({512, 512, 512}), 1e6), (GridIndex{9, 9, 2}));
  EXPECT_EQ(preview_step(whole({100, 100, 100}), 1e6), (GridIndex{6, 6, 1}));
  EXPECT_EQ(preview_step(whole({512, 512, 512}), 1e7), (GridIndex{19, 19, 4}));
  constexpr std::int32_t kMost = std::numeric_limits<std::int32_t>::max();
  const GridIndex step = preview_step(whole({2, 2, kMost}), 0);
  EXPECT_LE(kMost / step.k, 3 << 19);
}

TEST(Preview, IsTheBodyWhereItIs) {
  const Reconstruction result = look(preview_of_ball());
  ASSERT_EQ(result.levels.size(), 1u);
  EXPECT_EQ(result.levels[0].topology.components, 1);  // without the speck
  EXPECT_EQ(result.levels[0].topology.euler, 2);
  EXPECT_LT(farthest_from_ball(places(result), kCenter, kRadius), 0.05);
  EXPECT_NEAR(result.levels[0].measures.volume, kVolume, 0.01 * kVolume);
  EXPECT_LT(result.levels[0].topology.triangles, 60'000);  // every second trace
}

TEST(Preview, LiesInTheWorldAndInIndexSpaceAsTheBodyDoes) {
  const AffineGeometry geometry({1e6, 2e6, 500}, {0, 25, 0}, {12.5, 0, 0}, {0, 0, 4});
  auto options = preview_of_ball();
  const auto world = places(look(options, geometry));
  Vec3d middle;
  for (const Vec3d p : world) middle = middle + p * (1.0 / static_cast<double>(world.size()));
  const Vec3d expected = geometry.map(kCenter);
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(middle[axis], expected[axis], 20) << axis;
  options.index_space = true;
  EXPECT_LT(farthest_from_ball(places(look(options, geometry)), kCenter, kRadius), 0.05);
}

TEST(Preview, KeepsToTheRegionAndToTheSeed) {
  auto options = preview_of_ball();
  options.region = {{{21, 15, 20}, {160, 149, 169}}};
  options.bodies = {.seeds = {{78, 70, 80}}};
  const Reconstruction result = look(options);
  EXPECT_EQ(result.levels.at(0).topology.components, 1);
  EXPECT_LT(farthest_from_ball(places(result), kCenter, kRadius), 0.05);
}

TEST(Preview, OfEqualBodiesIsOneRequest) {
  ReconstructOptions options = preview_of_ball();
  options.levels = by_ratio({1, 0.1});
  options.grid = GridChoice::structural;
  options.fill.method = FillMethod::linear;
  const ReconstructOptions preview = preview_options(options);
  EXPECT_EQ(preview.levels.size(), 1u);
  EXPECT_EQ(preview.grid, GridChoice::given);
  EXPECT_EQ(preview.fill.method, FillMethod::none);
}

TEST(Preview, LiesOnTheGivenGridAlone) {
  auto options = preview_of_ball();
  options.grid = GridChoice::curvilinear;
  const AffineGeometry geometry;
  NoProgress progress;
  const auto result = reconstruct({ball(), geometry}, options, progress);
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::invalid_argument);
}

TEST(Preview, StopsWhenCancelled) {
  class Cancelled final : public Progress {
    void report(const char*, double) override {}
    bool cancelled() const override { return true; }
  } cancelled;
  const AffineGeometry geometry;
  const auto result = reconstruct({ball(), geometry}, preview_of_ball(), cancelled);
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::cancelled);
}

}  // namespace
}  // namespace geosis
