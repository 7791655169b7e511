#include "engine/isosurface/labelled_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "tests/engine/isosurface/sampled_volumes.h"

namespace geosis {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
const double kMissing = std::nan("");

std::vector<std::int64_t> voxels_of(const LabelledSurface& surface) {
  std::vector<std::int64_t> voxels;
  for (const BodySamples& body : surface.samples) voxels.push_back(body.voxels);
  return voxels;
}

using Voxels = std::vector<std::int64_t>;

double ball(double i, double j, double k, double at_i, double radius) {
  return radius - std::sqrt((i - at_i) * (i - at_i) + (j - 10) * (j - 10) + (k - 10) * (k - 10));
}

TEST(ExtractLabelledBody, TwoBallsAreTwoBodiesTheBiggerFirst) {
  const auto volume = sample_field(
      {40, 21, 21}, [](int i, int j, int k) { return std::max(ball(i, j, k, 8, 5.1), ball(i, j, k, 28, 7.1)); });
  const auto surface = label(*volume, {0, kInfinity}, {}, {.seeds = {{8, 10, 10}, {28, 10, 16}, {18, 10, 10}}});
  EXPECT_EQ(surface.samples.size(), 2u);
  EXPECT_NEAR(surface.volume_voxels[0], 4.0 / 3 * M_PI * 7.1 * 7.1 * 7.1, 30);
  EXPECT_EQ(surface.seed_body[0], 1u);
  EXPECT_EQ(surface.seed_body[1], 0u);
  EXPECT_FALSE(surface.seed_body[2]);
}

TEST(ExtractLabelledBody, CavityBelongsToTheShellAndTheBallInItDoesNot) {
  const auto volume = sample_field({21, 21, 21}, [](int i, int j, int k) {
    const double r = std::sqrt((i - 10.0) * (i - 10) + (j - 10.0) * (j - 10) + (k - 10.0) * (k - 10));
    return std::max(1.6 - std::fabs(r - 7.4), 3.1 - r);
  });
  const auto surface = label(*volume, {0, kInfinity}, {}, {.seeds = {{10, 10, 10}, {10, 10, 17}}});
  ASSERT_EQ(surface.samples.size(), 2u);
  EXPECT_NEAR(surface.volume_voxels[0], 4.0 / 3 * M_PI * (9.0 * 81 - std::pow(5.8, 3)), 60);
  EXPECT_EQ(surface.seed_body[0], 1u);
  EXPECT_EQ(surface.seed_body[1], 0u);
}

TEST(ExtractLabelledBody, ThinBandsBetweenNodesAreBodiesWithoutSamples) {
  const auto volume = sample_field({6, 6, 6}, [](int, int, int k) { return std::fabs(k - 2.5); });  // 2.5 .5 .5 2.5
  const auto surface = label(*volume, {0.75f, 1.25f}, {}, {.amplitudes = true});
  ASSERT_EQ(voxels_of(surface), (Voxels{0, 0}));
  EXPECT_DOUBLE_EQ(surface.volume_voxels[0], 25 * 0.5);
  EXPECT_FALSE(surface.samples[0].amplitude);
  EXPECT_EQ(surface.body.front(), 0u);  // equal volumes: the lower vertex first
}

TEST(ExtractLabelledBody, SlabOfASingleLevelIsABody) {
  const auto volume = sample_field({5, 5, 5}, [](int i, int, int) { return i; });
  EXPECT_EQ(voxels_of(label(*volume, {2, 2})), (Voxels{25}));
  EXPECT_EQ(voxels_of(label(*volume, {2.5f, 2.5f})), (Voxels{0}));
}

TEST(ExtractLabelledBody, DomainsThatTouchAlongAnEdgeOrAtAPointAreApart) {
  const auto along_edge = sample_field(
      {3, 3, 2}, [](int i, int j, int) { return (i == 0 && j == 2) || (i == 2 && j == 0) ? kMissing : 1; });
  const auto at_point = sample_field({3, 3, 3}, [](int i, int j, int k) {
    return (i == j && j == k) || (i < 2 && j < 2 && k < 2) || (i > 0 && j > 0 && k > 0) ? 1 : kMissing;
  });
  for (const bool cap : {true, false}) {
    // The nodes of the contact count once, for the body of their first cell.
    EXPECT_EQ(voxels_of(label(*along_edge, {0, 2}, {.cap = cap})), (Voxels{8, 6}));
    EXPECT_EQ(voxels_of(label(*at_point, {0, 2}, {.cap = cap})), (Voxels{8, 7}));
  }
}

TEST(ExtractLabelledBody, ADeadTraceOnTheWayMakesTwoBodies) {
  const auto volume = sample_field({9, 2, 4}, [](int i, int, int) { return i == 4 ? kMissing : 1; });
  EXPECT_EQ(voxels_of(label(*volume, {0, 2})), (Voxels{4 * 2 * 4, 4 * 2 * 4}));
}

TEST(ExtractLabelledBody, NodesWithoutACellAreInNoBody) {
  const auto volume = sample_field({4, 2, 2}, [](int i, int, int) { return i == 2 ? kMissing : 1; });
  const auto surface = label(*volume, {0, 2}, {}, {.seeds = {{3, 0, 0}, {0, 0, 0}}});
  EXPECT_EQ(voxels_of(surface), (Voxels{8}));
  EXPECT_FALSE(surface.seed_body[0]);
  EXPECT_EQ(surface.seed_body[1], 0u);
}

/// A ball through 4 bricks an axis; that in its middle holds no surface. Beside it, a small one.
const BrickedVolume& big_ball() {
  static const auto volume = sample_field({200, 196, 193}, [](int i, int j, int k) {
    const double x = i - 97.3, y = j - 96.1, z = k - 95.7;
    return i + j + k < 60 ? 4.2 - std::sqrt((i - 6.0) * (i - 6) + (j - 6.0) * (j - 6) + (k - 6.0) * (k - 6))
                          : 93.5 - std::sqrt(x * x + y * y + z * z);
  });
  return *volume;
}

TEST(ExtractLabelledBody, BricksWhollyInRangeJoinTheirNeighbours) {
  const GridIndex middle{95, 95, 95}, lower{6, 6, 6}, edge{126, 63, 126};
  const LabelOptions labels{.amplitudes = true, .seeds = {middle, lower, edge}};
  for (const bool cap : {true, false}) {
    const auto surface = label(big_ball(), {0, kInfinity}, {.cap = cap}, labels);
    ASSERT_EQ(surface.samples.size(), 2u);
    EXPECT_NEAR(static_cast<double>(surface.samples[0].voxels), 4.0 / 3 * M_PI * std::pow(93.5, 3), 3000);
    EXPECT_NEAR(surface.samples[0].amplitude->mean, 93.5 / 4, 0.05);  // of a cone
    EXPECT_GT(surface.samples[0].amplitude->max, 93);
    EXPECT_EQ(surface.seed_body, (std::vector<std::optional<std::uint32_t>>{0u, 1u, 0u}));
  }
}

TEST(ExtractLabelledBody, SamplesAreCountedOnceInAnyRegion) {
  for (const GridBox& region :
       {GridBox{{63, 63, 63}, {126, 126, 126}}, {{60, 63, 64}, {127, 126, 125}}, {{97, 62, 1}, {98, 190, 192}}}) {
    std::int64_t expected = 0;
    for (int i = region.first.i; i <= region.last.i; ++i) {
      for (int j = region.first.j; j <= region.last.j; ++j) {
        for (int k = region.first.k; k <= region.last.k; ++k) {
          expected += (i - 97.3) * (i - 97.3) + (j - 96.1) * (j - 96.1) + (k - 95.7) * (k - 95.7) <= 93.5 * 93.5;
        }
      }
    }
    for (const bool cap : {true, false}) {
      const auto surface = label(big_ball(), {0, kInfinity}, {.cap = cap, .region = region}, {.seeds = {region.last}});
      EXPECT_EQ(voxels_of(surface), Voxels{expected}) << region.first.i << " " << cap;
    }
  }
}

TEST(ExtractLabelledBody, ATubeThatWindsThroughBricksIsOneBody) {
  const auto volume = sample_field({130, 130, 66}, [](int i, int j, int k) {
    const double wave = 64 + 50 * std::sin(i * 0.12);
    return 3 - std::hypot((j - wave) / 2, k - 63.0);
  });
  EXPECT_EQ(label(*volume, {0, kInfinity}).samples.size(), 1u);
  EXPECT_EQ(label(*volume, {0, kInfinity}, {.cap = false}).samples.size(), 1u);
  EXPECT_EQ(label(*volume, {0, kInfinity}, {.mode = BodyMode::sampled}).samples.size(), 1u);
}

TEST(ExtractLabelledBody, RangeOpenOnBothSidesIsTheDomain) {
  const auto volume = sample_field({66, 4, 5}, [](int i, int, int) { return i == 60 ? kMissing : 1; });
  for (const bool cap : {true, false}) {
    const auto surface = label(*volume, {-kInfinity, kInfinity}, {.cap = cap});
    EXPECT_EQ(voxels_of(surface), (Voxels{60 * 4 * 5, 5 * 4 * 5}));
    EXPECT_EQ(surface.body.empty(), !cap);
  }
}

TEST(ExtractLabelledBody, NothingThereIsNoBody) {
  const auto missing = sample_field({4, 4, 4}, [](int, int, int) { return kMissing; });
  const auto outside = sample_field({4, 4, 4}, [](int, int, int) { return 9; });
  for (const auto* volume : {&missing, &outside}) {
    const auto surface = label(**volume, {0, 2}, {}, {.amplitudes = true, .seeds = {{1, 1, 1}, {-1, 0, 9}}});
    EXPECT_TRUE(surface.samples.empty());
    EXPECT_FALSE(surface.seed_body[0] || surface.seed_body[1]);
  }
}

TEST(ExtractLabelledBody, AMirroringGeometryKeepsVolumesPositive) {
  const auto volume = sample_field({4, 5, 6}, [](int, int, int) { return 1; });
  EXPECT_EQ(label(*volume, {0, 2}, {.mirrored = true}).volume_voxels, std::vector<double>{3 * 4 * 5});
}

TEST(ExtractLabelledBody, ThreadsDoNotChangeTheLabels) {
  const auto volume = sample_field({66, 40, 66}, [](int i, int j, int k) {
    return (i * 7 + j * 13 + k * 5) % 97 == 0 ? kMissing : (i * 31 + j * 17 + k * 29) % 23 - 11;
  });
  const LabelOptions labels{.amplitudes = true, .seeds = {{5, 6, 7}}};
  const auto one = label(*volume, {-3, 4}, {.threads = 1}, labels);
  EXPECT_GT(one.body.size(), 50000u);
  for (const int threads : {2, 3}) {
    const auto several = label(*volume, {-3, 4}, {.threads = threads}, labels);
    EXPECT_EQ(one.body, several.body);
    EXPECT_EQ(one.volume_voxels, several.volume_voxels);
    EXPECT_EQ(voxels_of(one), voxels_of(several));
    EXPECT_EQ(one.samples[0].amplitude->mean, several.samples[0].amplitude->mean);
  }
}

TEST(ExtractLabelledBody, RefusesWhatExtractBodyRefuses) {
  const auto volume = sample_field({4, 4, 4}, [](int, int, int) { return 1; });
  NoProgress progress;
  const auto refused = [&](IsoRange range, const ExtractOptions& options) {
    const auto surface = extract_labelled_body(*volume, range, options, {}, progress);
    return surface ? ErrorCode::internal : surface.error().code;
  };
  EXPECT_EQ(refused({2, 1}, {.region = whole(volume->shape())}), ErrorCode::invalid_argument);
  EXPECT_EQ(refused({0, 2}, {.region = {{0, 0, 0}, {4, 3, 3}}}), ErrorCode::invalid_argument);
  EXPECT_EQ(refused({0, 2}, {.region = whole(volume->shape()), .max_triangles = 10}), ErrorCode::limit_exceeded);
}

}  // namespace
}  // namespace geosis
