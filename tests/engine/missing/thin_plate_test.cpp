#include "engine/missing/plate/thin_plate.h"

#include <cmath>
#include <cstring>
#include <limits>

#include <gtest/gtest.h>

#include "engine/missing/plate/plate_gaps.h"
#include "engine/missing/plate/wide_plate.h"
#include "tests/engine/missing/gap_boxes.h"
#include "tests/engine/missing/plate_oracle.h"
#include "tests/support/random.h"

namespace geosis::test {
namespace {

constexpr Vec3d kEqualSteps{1, 1, 1};
constexpr Vec3d kSeismicSteps{0.5, 0.25, 0.65};  // c = 0.25, 1, 0.148

const auto linear = [](int i, int j, int k) { return 3 + 2 * i - 0.5 * j + 0.25 * k; };

Vec3d weights_of(Vec3d steps) {
  const double shortest = std::min({steps.x, steps.y, steps.z});
  return {shortest * shortest / (steps.x * steps.x), shortest * shortest / (steps.y * steps.y),
          shortest * shortest / (steps.z * steps.z)};
}

GapBox noise_box(GridShape shape, Random& random) {
  return known_box(shape, [&](int, int, int) { return random.between(-1, 1); });
}

void fill(GapBox& gap, Vec3d steps, double tolerance) {
  fill_thin_plate(gap, steps, {.tolerance = tolerance}, NoProgress());
}

/// The largest difference from the oracle.
double difference(const GapBox& filled, const GapBox& asked, Vec3d steps) {
  const std::vector<double> expected = least_bending(asked, weights_of(steps));
  double largest = 0;
  std::size_t n = 0;
  for (std::size_t place = 0; place < asked.state.size(); ++place)
    if (asked.state[place] == NodeState::wanted)
      largest = std::max(largest, std::abs(static_cast<double>(filled.samples.value[place]) - expected[n++]));
  return largest;
}

void expect_least_bending(const GapBox& asked, Vec3d steps, double bound = 2e-5) {
  GapBox filled = asked;
  fill(filled, steps, 1e-7);
  EXPECT_LT(difference(filled, asked, steps), bound);
}

TEST(ThinPlate, BendsLeastAtScatteredPoints) {
  const std::uint64_t seed = test_seed(1);
  SCOPED_TRACE(testing::Message() << "GEOSIS_SEED=" << seed);
  Random random(seed);
  for (const double share : {0.01, 0.05, 0.2, 0.4}) {
    GapBox gap = noise_box({9, 10, 11}, random);
    knock_out(gap, [&](int, int, int) { return random.unit() < share; });
    expect_least_bending(gap, kEqualSteps);
    expect_least_bending(gap, kSeismicSteps);
  }
}

TEST(ThinPlate, BendsLeastAtMissingTraces) {
  Random random(2);
  GapBox gap = noise_box({9, 9, 8}, random);
  bool is_dead[9][9];
  for (auto& row : is_dead)
    for (bool& dead : row) dead = random.unit() < 0.3;
  knock_out(gap, [&](int i, int j, int) { return is_dead[i][j]; });
  expect_least_bending(gap, kSeismicSteps);
}

TEST(ThinPlate, BendsLeastInWideGaps) {
  Random random(3);
  for (const Vec3d steps : {kEqualSteps, kSeismicSteps}) {
    GapBox cube = noise_box({11, 12, 11}, random);
    knock_out(cube, cube_gap(7));
    expect_least_bending(cube, steps);
    GapBox ball = noise_box({12, 12, 12}, random);
    knock_out(ball, [](int i, int j, int k) {
      return (i - 5) * (i - 5) + (j - 6) * (j - 6) + (k - 6) * (k - 6) < 16 && !(i == 5 && j == 6);
    });
    expect_least_bending(ball, steps);
  }
}

TEST(ThinPlate, EndsFreeAtTheSurveysEdgeAndAtAbsentNodes) {
  Random random(4);
  for (const Vec3d steps : {kEqualSteps, kSeismicSteps}) {
    GapBox corner = noise_box({9, 9, 9}, random);
    knock_out(corner, [](int i, int j, int k) { return i < 6 && j < 5 && k < 6; });
    expect_least_bending(corner, steps, 1e-4);
    GapBox narrow = noise_box({9, 9, 9}, random);
    knock_out(narrow, [](int i, int j, int) { return i < 2 && j > 3; });
    remove(narrow, [](int i, int j, int) { return i + j > 12; });
    expect_least_bending(narrow, steps, 1e-4);
    GapBox outline = noise_box({12, 12, 10}, random);
    knock_out(outline, [](int i, int j, int k) { return i > 3 && j > 3 && k > 1 && k < 8; });
    remove(outline, [](int i, int j, int) { return i + j > 16; });
    expect_least_bending(outline, steps, 1e-4);
  }
}

TEST(ThinPlate, ReproducesLinearFieldsInGapsOfEveryKind) {
  for (const int size : {1, 2, 4, 5, 12}) {
    GapBox gap = known_box({size + 4, size + 4, size + 4}, linear);
    knock_out(gap, cube_gap(size), 10);
    fill(gap, kSeismicSteps, 1e-6);
    EXPECT_LT(largest_error(gap, linear), 4e-5) << size;  // values up to 40
  }
}

TEST(ThinPlate, ContinuesLinearFieldsBeyondTheSurveysEdge) {
  GapBox gap = known_box({12, 12, 12}, linear);
  knock_out(gap, [](int i, int j, int) { return i > 5 && j > 5; });
  remove(gap, [](int i, int j, int) { return i + j > 19; });
  fill(gap, kSeismicSteps, 1e-7);
  EXPECT_LT(largest_error(gap, linear), 1e-4);
}

TEST(ThinPlate, ReproducesBiharmonicQuadratics) {
  const auto saddle = [](int i, int j, int) { return i * i - j * j; };
  const auto twist = [](int i, int, int k) { return i * k; };
  for (const int size : {1, 3, 9, 24}) {
    GapBox gap = known_box({size + 4, size + 4, size + 4}, saddle);
    knock_out(gap, cube_gap(size));
    fill(gap, kEqualSteps, 1e-6);
    EXPECT_LT(largest_error(gap, saddle), 1e-5 * size * size) << size;
    GapBox other = known_box({size + 4, size + 4, size + 4}, twist);
    knock_out(other, cube_gap(size));
    fill(other, kSeismicSteps, 1e-6);
    EXPECT_LT(largest_error(other, twist), 1e-5 * size * size) << size;
  }
}

TEST(ThinPlate, LeavesAStartThatBendsNowhereAsItIs) {
  GapBox gap = known_box({24, 24, 24}, linear);
  const GapBox before = gap;
  knock_out(gap, cube_gap(20));
  gap.samples = before.samples;
  const PlateGaps gaps = find_plate_gaps(gap, NoProgress());
  ASSERT_EQ(gaps.gaps.size(), 1u);
  EXPECT_EQ(fill_wide_plate(gap, gaps.nodes, {1, 1, 1}, {}, NoProgress()).iterations, 0);
  EXPECT_EQ(gap.samples.value, before.samples.value);
}

TEST(ThinPlate, NeedsFewIterationsInWideGaps) {
  Random random(5);
  for (const auto& [size, weights, bound] : {std::tuple(20, Vec3d{1, 1, 1}, 12), std::tuple(40, Vec3d{1, 1, 1}, 18),
                                             std::tuple(40, Vec3d{1, 1, 0.15}, 25)}) {
    GapBox gap = noise_box({size + 4, size + 4, size + 4}, random);
    knock_out(gap, cube_gap(size));
    const PlateGaps gaps = find_plate_gaps(gap, NoProgress());
    const WidePlateEffort effort = fill_wide_plate(gap, gaps.nodes, weights, {}, NoProgress());
    EXPECT_LE(effort.iterations, bound) << size << ' ' << weights.z;
    EXPECT_EQ(effort.rounds, 1);
  }
}

TEST(ThinPlate, FillsAGapTheSameWhateverElseTheBoxHolds) {
  Random random(6);
  GapBox whole = noise_box({20, 20, 20}, random);
  knock_out(whole, [](int i, int j, int k) { return i >= 4 && i < 7 && j >= 4 && j < 7 && k >= 4 && k < 7; });
  GapBox crowded = whole;
  knock_out(crowded, [](int i, int j, int k) { return i > 11 && j > 11 && k > 11; });
  fill(whole, kSeismicSteps, 1e-3);
  fill(crowded, kSeismicSteps, 1e-3);
  for_each_node({8, 8, 8}, [&](int i, int j, int k) {
    EXPECT_EQ(whole.samples.value[whole.samples.at(i, j, k)], crowded.samples.value[whole.samples.at(i, j, k)]);
  });
}

/// A gap of every kind: a point, a pair, traces, a wide one, one at the edge.
GapBox mixed_gaps(float amplitude, std::uint64_t seed) {
  Random random(seed);
  GapBox gap = known_box({20, 20, 20}, [&](int, int, int) { return amplitude * random.between(-1, 1); });
  knock_out(gap, [](int i, int j, int k) {
    return (i == 3 && j == 3 && k == 3) || (i == 3 && j == 10 && (k == 3 || k == 4)) || (i == 6 && j == 16) ||
           (i > 9 && i < 16 && j > 2 && j < 10 && k > 5 && k < 13) || (i > 16 && j > 14);
  });
  return gap;
}

TEST(ThinPlate, DoesNotCareAboutTheSizeOfAmplitudes) {
  GapBox plain = mixed_gaps(1, 7);
  fill(plain, kSeismicSteps, 1e-3);
  for (const float scale : {0x1p-100f, 0x1p-20f, 0x1p20f, 0x1p100f}) {
    GapBox gap = mixed_gaps(scale, 7);
    fill(gap, kSeismicSteps, 1e-3);
    for (std::size_t place = 0; place < gap.state.size(); ++place)
      ASSERT_EQ(gap.samples.value[place], plain.samples.value[place] * scale) << scale << ' ' << place;
  }
}

TEST(ThinPlate, StaysFiniteAtTheLargestFloats) {
  constexpr float kLargest = std::numeric_limits<float>::max();
  GapBox gap = mixed_gaps(kLargest, 8);
  fill(gap, kEqualSteps, 1e-3);
  for (const float value : gap.samples.value) ASSERT_TRUE(std::isfinite(value));
  GapBox tiny = mixed_gaps(std::numeric_limits<float>::denorm_min() * 5, 8);
  fill(tiny, kEqualSteps, 1e-3);
  for (const float value : tiny.samples.value) ASSERT_LT(std::abs(value), 1e-43f);
}

TEST(ThinPlate, ClampsToTheRange) {
  GapBox gap = mixed_gaps(1, 9);
  const GapBox before = gap;
  fill_thin_plate(gap, kSeismicSteps, {.low = -0.1f, .high = 0.05f}, NoProgress());
  for (std::size_t place = 0; place < gap.state.size(); ++place) {
    if (gap.state[place] == NodeState::known) {
      EXPECT_EQ(gap.samples.value[place], before.samples.value[place]);
    } else {
      EXPECT_GE(gap.samples.value[place], -0.1f);
      EXPECT_LE(gap.samples.value[place], 0.05f);
    }
  }
}

TEST(ThinPlate, KeepsTheStartWhereNothingIsKnown) {
  GapBox gap = known_box({8, 8, 8}, linear);
  knock_out(
      gap, [](int, int, int) { return true; }, 2.5f);
  fill(gap, kEqualSteps, 1e-3);
  for (const float value : gap.samples.value) EXPECT_EQ(value, 2.5f);
  GapBox lonely = known_box({3, 3, 3}, linear);
  remove(lonely, [](int, int, int) { return true; });
  knock_out(
      lonely, [](int i, int j, int k) { return i == 1 && j == 1 && k == 1; }, 2.5f);
  fill(lonely, kEqualSteps, 1e-3);
  EXPECT_EQ(lonely.samples.value[lonely.samples.at(1, 1, 1)], 2.5f);
}

TEST(ThinPlate, TakesBoxesOfOneNodeAnAxis) {
  for (const GridShape shape : {GridShape{1, 1, 1}, GridShape{1, 1, 9}, GridShape{1, 9, 9}, GridShape{9, 1, 1}}) {
    GapBox gap = known_box(shape, linear);
    knock_out(
        gap, [&](int i, int j, int k) { return (i + j + k) % 4 == 2; }, 1);
    fill(gap, kSeismicSteps, 1e-7);
    EXPECT_LT(largest_error(gap, linear), 1e-4);
  }
}

TEST(ThinPlate, GivesTheSameBytesEveryTime) {
  GapBox one = mixed_gaps(1, 10), two = one;
  fill(one, kSeismicSteps, 1e-3);
  fill(two, kSeismicSteps, 1e-3);
  EXPECT_EQ(std::memcmp(one.samples.value.data(), two.samples.value.data(), one.samples.value.size() * sizeof(float)),
            0);
}

TEST(ThinPlate, StopsSoonWhenCancelled) {
  for (int question = 0; question < 60; ++question) {
    GapBox gap = mixed_gaps(1, 11);
    fill_thin_plate(gap, kSeismicSteps, {.tolerance = 1e-7}, CancelledAt(question));
    for (const float value : gap.samples.value) ASSERT_TRUE(std::isfinite(value));
  }
}

}  // namespace
}  // namespace geosis::test
