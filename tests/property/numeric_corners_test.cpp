#include <array>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "engine/base/progress.h"
#include "engine/volume/brick_file.h"
#include "tests/property/surface_laws.h"
#include "tests/support/phantoms.h"

// Values and ranges at the ends of what float32 holds: closed, manifold, decodable, and right where that can be told.

namespace geosis::test {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr float kMax = std::numeric_limits<float>::max();
constexpr float kSmallest = std::numeric_limits<float>::denorm_min();
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr std::array kModes = {BodyMode::exact, BodyMode::sampled};

// All laws in both modes; decided: the oracle must be able to tell what is right.
void expect_laws(const ScalarField& field, IsoRange range, bool decided = true) {
  for (const BodyMode mode : kModes) {
    for (const auto judge : {judge_closed_surface, judge_open_surface, judge_decoded_surface}) {
      const Verdict verdict = judge(field, range, mode);
      EXPECT_EQ(verdict.broken, "") << "range " << range.low << " to " << range.high;
      EXPECT_TRUE(verdict.decided || !decided) << "range " << range.low << " to " << range.high;
    }
  }
}

MeshCensus census_of(const ScalarField& field, IsoRange range, BodyMode mode = BodyMode::exact) {
  return census(extract_surface(field, range, mode));
}

ScalarField noise(Random& random, float scale) {
  ScalarField field = uniform_noise({5, 5, 5}, random, -1, 1);
  for (float& f : field.samples) f *= scale;
  return field;
}

TEST(NumericCorners, ConstantVolumeIsTheBoxOrNothing) {
  const ScalarField field({4, 3, 5}, 7);
  for (const IsoRange inside : {IsoRange{7, 7}, {7, 9}, {5, 7}, {5, 9}, {-kInf, 7}, {7, kInf}, {-kInf, kInf}}) {
    for (const BodyMode mode : kModes) {
      const MeshCensus found = census_of(field, inside, mode);
      EXPECT_TRUE(found.is_closed_manifold());
      EXPECT_EQ(found.volume, 3 * 2 * 4);
      EXPECT_EQ(found.euler(), 2);
    }
  }
  for (const IsoRange outside : {IsoRange{8, 9}, {-kInf, 6}, {std::nextafter(7.0f, 8.0f), kInf}}) {
    for (const BodyMode mode : kModes) EXPECT_EQ(census_of(field, outside, mode).triangles, 0);
  }
}

TEST(NumericCorners, AllSamplesMissingIsNothing) {
  const ScalarField field({4, 4, 4}, kNaN);
  for (const BodyMode mode : kModes) {
    EXPECT_EQ(census_of(field, {-kInf, kInf}, mode).triangles, 0);
    EXPECT_EQ(census_of(field, {0, 1}, mode).triangles, 0);
  }
}

TEST(NumericCorners, OneSampleThickIsRefusedByName) {
  for (const GridShape shape : {GridShape{1, 4, 4}, {4, 1, 4}, {4, 4, 1}}) {
    const ScalarField field(shape, 1);
    const auto volume = make_bricked_volume(shape, field.samples);
    NoProgress progress;
    const auto mesh = extract_body(*volume, {0, 2}, {.region = whole(shape)}, progress);
    ASSERT_FALSE(mesh);
    EXPECT_EQ(mesh.error().code, ErrorCode::invalid_argument);
    EXPECT_NE(mesh.error().message.find("two nodes"), std::string::npos) << mesh.error().message;
  }
}

TEST(NumericCorners, TwoNodesAnAxisAreEnough) {
  Random random(test_seed(5));
  for (int trial = 0; trial < 100; ++trial) expect_laws(uniform_noise({2, 2, 2}, random, -1, 1), {-0.3f, 0.4f});
}

TEST(NumericCorners, RangeOutsideTheDataIsNothing) {
  Random random(test_seed(6));
  const ScalarField field = noise(random, 1);
  for (const IsoRange range : {IsoRange{2, 3}, {-3, -2}, {2, kInf}, {-kInf, -2}, {kMax, kInf}, {-kInf, -kMax}}) {
    for (const BodyMode mode : kModes) EXPECT_EQ(census_of(field, range, mode).triangles, 0);
  }
}

TEST(NumericCorners, BothEndsInfiniteIsTheDomain) {
  Random random(test_seed(7));
  expect_laws(noise(random, 1), {-kInf, kInf});
  EXPECT_EQ(census_of(noise(random, 1), {-kInf, kInf}).volume, 64);
  expect_laws(with_holes(noise(random, 1), random, 0.05), {-kInf, kInf});
}

// An infinity that stands for both ends holds no finite sample.
TEST(NumericCorners, AnInfiniteSlabIsNothing) {
  Random random(test_seed(8));
  const ScalarField field = noise(random, 1);
  for (const IsoRange range : {IsoRange{kInf, kInf}, {-kInf, -kInf}}) {
    for (const BodyMode mode : kModes) EXPECT_EQ(census_of(field, range, mode).triangles, 0) << range.low;
  }
}

TEST(NumericCorners, NarrowRangesCrossEdgesTwice) {
  Random random(test_seed(9));
  for (int trial = 0; trial < 50; ++trial) {
    const ScalarField field = noise(random, 1);
    const float low = random.between(-0.4f, 0.4f);
    expect_laws(field, {low, low});
    expect_laws(field, {low, std::nextafter(low, kInf)}, false);
    expect_laws(field, {low, low + 1e-3f});
  }
}

TEST(NumericCorners, SubnormalSamples) {
  Random random(test_seed(10));
  for (int trial = 0; trial < 30; ++trial) {
    expect_laws(noise(random, 1e-40f), {-2e-41f, 3e-41f}, false);
    expect_laws(integer_noise({4, 4, 4}, random, -3, 3), {kSmallest, kInf}, false);
    ScalarField steps = integer_noise({4, 4, 4}, random, -9, 9);
    for (float& f : steps.samples) f *= kSmallest;
    expect_laws(steps, {-kSmallest, 2 * kSmallest}, false);
  }
}

TEST(NumericCorners, SamplesNearTheLargestFloat) {
  Random random(test_seed(11));
  for (int trial = 0; trial < 30; ++trial) {
    expect_laws(noise(random, kMax), {-0.3f * kMax, 0.4f * kMax}, false);
    expect_laws(noise(random, kMax), {0, kInf}, false);
    ScalarField extremes = integer_noise({4, 4, 4}, random, 0, 1);
    for (float& f : extremes.samples) f = f > 0 ? kMax : -kMax;
    expect_laws(extremes, {-kMax, 0}, false);
    expect_laws(extremes, {0, kMax}, false);
    expect_laws(extremes, {kMax, kInf}, false);
  }
}

ScalarField of_many_magnitudes(Random& random, int exponent) {
  ScalarField field = noise(random, 1);
  for (float& f : field.samples) f *= std::ldexp(1.0f, random.integer(-exponent, exponent));
  return field;
}

TEST(NumericCorners, LargeAndSmallSamplesTogether) {
  Random random(test_seed(12));
  for (int trial = 0; trial < 30; ++trial) expect_laws(of_many_magnitudes(random, 8), {-0.01f, 10}, false);
}

// Beyond what the oracle's floating-point numbers can tell, the surface is closed and manifold still.
TEST(NumericCorners, LargestAndSmallestSamplesTogether) {
  Random random(test_seed(15));
  for (int trial = 0; trial < 50; ++trial) {
    const ScalarField field = of_many_magnitudes(random, 126);
    for (const IsoRange range : {IsoRange{0, kInf}, {-1e-20f, 1e10f}}) {
      for (const BodyMode mode : kModes) {
        EXPECT_TRUE(census_of(field, range, mode).is_closed_manifold());
        EXPECT_EQ(judge_decoded_surface(field, range, mode).broken, "");
      }
    }
  }
}

TEST(NumericCorners, IntegerPlateausOnTheIsovalue) {
  Random random(test_seed(13));
  for (int trial = 0; trial < 50; ++trial) {
    const ScalarField field = integer_noise({6, 5, 4}, random, 0, 2);
    for (const IsoRange range : {IsoRange{1, 1}, {0, 1}, {1, 2}, {1, kInf}, {-kInf, 1}})
      expect_laws(field, range, false);
  }
}

TEST(NumericCorners, MinusZeroIsZero) {
  Random random(test_seed(14));
  for (int trial = 0; trial < 20; ++trial) {
    const ScalarField field = integer_noise({5, 4, 4}, random, -1, 1);
    ScalarField negative = field;
    for (float& f : negative.samples) f = f == 0 ? -0.0f : f;
    for (const BodyMode mode : kModes) {
      for (const auto& [plus, minus] :
           {std::pair{IsoRange{0, kInf}, IsoRange{-0.0f, kInf}}, std::pair{IsoRange{-kInf, 0}, IsoRange{-kInf, -0.0f}},
            std::pair{IsoRange{0, 0}, IsoRange{-0.0f, 0}}}) {
        const IndexedMesh expected = extract_surface(field, plus, mode);
        for (const ScalarField* samples : std::array<const ScalarField*, 2>{&field, &negative}) {
          const IndexedMesh found = extract_surface(*samples, minus, mode);
          EXPECT_EQ(found.positions, expected.positions);
          EXPECT_EQ(found.triangles, expected.triangles);
        }
      }
    }
  }
}

}  // namespace
}  // namespace geosis::test
