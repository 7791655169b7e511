#include "engine/missing/fill.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "tests/engine/missing/fill_oracle.h"
#include "tests/engine/missing/gappy_fields.h"

namespace geosis {
namespace {

using test::for_each_node;
using test::ScalarField;

constexpr FillOptions kLinear{.method = FillMethod::linear};

std::int64_t count_missing(const ScalarField& field) {
  return std::ranges::count_if(field.samples, [](float value) { return std::isnan(value); });
}

void expect_near(const ScalarField& filled, const ScalarField& truth, double tolerance) {
  double worst = 0;
  std::int64_t nan = 0;
  for (std::size_t n = 0; n < truth.samples.size(); ++n) {
    nan += std::isnan(filled.samples[n]) != std::isnan(truth.samples[n]);
    if (!std::isnan(truth.samples[n])) worst = std::max(worst, std::abs(double{filled.samples[n]} - truth.samples[n]));
  }
  EXPECT_EQ(nan, 0);
  EXPECT_LE(worst, tolerance);
}

/// Law: value, reliability and which nodes are filled are those of the description, whatever the gaps.
TEST(FillMissing, AgreesWithTheDescriptionOnRandomGaps) {
  const std::uint64_t seed = test::test_seed(1);
  for (std::uint64_t round = 0; round < 60; ++round) {
    SCOPED_TRACE(testing::Message() << "seed " << seed + round);
    test::Random random(seed + round);
    GridShape shape{random.integer(1, 9), random.integer(1, 9), random.integer(1, 9)};
    if (round % 20 == 0) shape = {3, 4, 130};
    if (round % 20 == 1) shape = {70, 3, 4};
    if (round % 20 == 2) shape = {2, 129, 3};
    const ScalarField field = test::with_random_gaps(test::uniform_noise(shape, random, -5, 20), random);
    FillOptions options = kLinear;
    if (round % 3 == 0) options.max_distance = 1 + 4 * random.unit();
    const auto oracle = test::fill_slowly(field, test::measure_steps(field), options.max_distance);
    const auto volume = test::volume_of(field);
    const auto filled = test::fill(*volume, options);
    expect_near(test::samples_of(*filled), test::filled_slowly(field, oracle), 1e-4);
    const auto expected = std::ranges::count_if(oracle, [](const auto& node) { return node.distance >= 0; });
    EXPECT_EQ(filled->filled_count(), expected);
    for (std::size_t brick = 0; brick < filled->brick_count(); ++brick) {
      const auto view = volume->brick(brick);
      for (const FilledSample& record : filled->filled(brick)) {
        const auto place = static_cast<std::int32_t>(record.place);
        const GridIndex node{view->first.i + place / view->extent.samples / view->extent.crosslines,
                             view->first.j + place / view->extent.samples % view->extent.crosslines,
                             view->first.k + place % view->extent.samples};
        const double d = oracle[field.index(node)].distance;
        EXPECT_NEAR(record.reliability, 254 / (1 + std::pow(d / 0.4, 3)), 0.501);
      }
    }
  }
}

TEST(FillMissing, ReproducesLinearFieldsInsideEveryTwoSidedGap) {
  const ScalarField truth = test::plane({20, 18, 70}, 3, -2, 0.25, 7);
  ScalarField field = test::without(truth, {{5, 4, 10}, {12, 13, 66}});
  field = test::without_trace(std::move(field), 3, 9);
  field = test::without(std::move(field), {{15, 0, 8}, {15, 17, 8}});
  test::Random random(3);
  for_each_node(truth.shape, [&](GridIndex n) {
    const bool border = n.i == 0 || n.j == 0 || n.k == 0 || n.i == 19 || n.j == 17 || n.k == 69;
    if (!border && random.unit() < 0.1) field.at(n) = test::kMissing;
  });
  expect_near(test::fill(field), truth, 2e-5);
}

TEST(FillMissing, StaysBetweenSmallestAndLargestSample) {
  test::Random random(11);
  const ScalarField field = test::with_holes(test::uniform_noise({12, 12, 40}, random, 2, 3), random, 0.6);
  const ScalarField filled = test::fill(field);
  const auto valid = [](float value) { return !std::isnan(value); };
  float low = 3, high = 2;
  for (const float value : field.samples)
    if (valid(value)) low = std::min(low, value), high = std::max(high, value);
  for (const float value : filled.samples) {
    EXPECT_GE(value, low);
    EXPECT_LE(value, high);
  }
}

TEST(FillMissing, LeavesWhatLiesOutsideTheSurveyPolygonMissing) {
  ScalarField field = test::plane({20, 20, 5}, 1, 1, 1, 0);
  const auto outside = [](std::int32_t i, std::int32_t j) { return i + j < 12 || i + j > 28 || i - j > 9; };
  for (std::int32_t i = 0; i < 20; ++i)
    for (std::int32_t j = 0; j < 20; ++j)
      if (outside(i, j)) field = test::without_trace(std::move(field), i, j);
  const std::int64_t left = count_missing(field);
  field = test::without_trace(std::move(field), 10, 10);
  const ScalarField filled = test::fill(field);
  EXPECT_EQ(count_missing(filled), left);
  EXPECT_FLOAT_EQ(filled.at({10, 10, 3}), 23);
}

TEST(FillMissing, FillsLinesThatWereNotShotWhereTheOtherLinesAreInside) {
  const ScalarField truth = test::plane({12, 10, 6}, 1, -2, 3, 0);
  ScalarField field = test::without(truth, {{4, 0, 0}, {6, 9, 5}});
  expect_near(test::fill(field), truth, 1e-4);
  field = test::without(std::move(field), {{0, 7, 0}, {11, 7, 5}});
  expect_near(test::fill(field), truth, 0.5);            // where the lines cross, distances are carried on
  field = test::without(truth, {{0, 0, 0}, {2, 9, 5}});  // before the first inline: outside
  EXPECT_EQ(count_missing(test::fill(field)), 3 * 10 * 6);
}

TEST(FillMissing, FillsValidTracesOnTheSurveysBorderFromTopToBottom) {
  ScalarField field(GridShape{3, 3, 8}, 4);
  field = test::without(std::move(field), {{0, 0, 0}, {0, 0, 2}});  // muted
  field = test::without(std::move(field), {{2, 2, 5}, {2, 2, 7}});  // cut off
  field = test::without(std::move(field), {{0, 2, 0}, {0, 2, 7}});  // dead, on the border: outside
  const ScalarField filled = test::fill(field);
  EXPECT_EQ(count_missing(filled), 8);
  EXPECT_EQ(filled.at({0, 0, 0}), 4);
  EXPECT_EQ(filled.at({2, 2, 7}), 4);
}

TEST(FillMissing, KeepsTheMiddleOfBigGapsMissing) {
  const ScalarField field = test::without(ScalarField(GridShape{31, 31, 31}, 1), {{5, 5, 5}, {25, 25, 25}});
  FillOptions options = kLinear;
  options.max_distance = 3;
  const ScalarField filled = test::fill(field, options);
  for_each_node(field.shape, [&](GridIndex n) {
    const bool middle = n.i > 7 && n.i < 23 && n.j > 7 && n.j < 23 && n.k > 7 && n.k < 23;
    EXPECT_EQ(std::isnan(filled.at(n)), middle) << n.i << " " << n.j << " " << n.k;
  });
  // Nearer nodes get the values that they have without a limit.
  test::Random random(5);
  const ScalarField noise = test::with_holes(test::uniform_noise({9, 9, 9}, random, 0, 1), random, 0.8);
  options.max_distance = 1;
  const ScalarField all = test::fill(noise), near = test::fill(noise, options);
  for (std::size_t n = 0; n < all.samples.size(); ++n)
    if (!std::isnan(near.samples[n])) {
      EXPECT_EQ(near.samples[n], all.samples[n]);
    }
}

TEST(FillMissing, HandlesVolumesOneSampleThick) {
  for (int axis = 0; axis < 3; ++axis) {
    SCOPED_TRACE(axis);
    GridShape shape{axis == 0 ? 1 : 7, axis == 1 ? 1 : 7, axis == 2 ? 1 : 7};
    ScalarField field = test::plane(shape, 1, 2, 3, 0);
    const ScalarField truth = field;
    field.at({shape.inlines / 2, shape.crosslines / 2, shape.samples / 2}) = test::kMissing;
    expect_near(test::fill(field), truth, 1e-5);
  }
  ScalarField lone(GridShape{1, 1, 1}, test::kMissing);
  EXPECT_EQ(count_missing(test::fill(lone)), 1);
}

TEST(FillMissing, GivesConstantFieldsBackConstant) {
  test::Random random(7);
  const ScalarField field = test::with_holes(ScalarField(GridShape{10, 10, 10}, -3.7f), random, 0.5);
  const ScalarField filled = test::fill(field);
  EXPECT_TRUE(std::ranges::all_of(filled.samples, [](float value) { return value == -3.7f; }));
}

TEST(FillMissing, GivesFiniteValuesForTheLargestSamples) {
  test::Random random(9);
  ScalarField field = test::uniform_noise({6, 6, 6}, random, -1, 1);
  for (float& value : field.samples) value = value < 0 ? -std::numeric_limits<float>::max() : 3e38f;
  field = test::with_holes(std::move(field), random, 0.4);
  const ScalarField filled = test::fill(field);
  EXPECT_TRUE(std::ranges::all_of(filled.samples, [](float value) { return std::isfinite(value); }));
}

TEST(FillMissing, HasNothingToDoForWholeAndForEmptyVolumes) {
  const auto whole = test::volume_of(ScalarField(GridShape{5, 70, 5}, 2));
  const auto empty = test::volume_of(ScalarField(GridShape{5, 70, 5}, test::kMissing));
  for (const BrickedVolume* volume : {whole.get(), empty.get()}) {
    const auto filled = test::fill(*volume);
    EXPECT_EQ(filled->filled_count(), 0);
    EXPECT_EQ(filled->brick(1)->samples, volume->brick(1)->samples);  // passed through
    EXPECT_EQ(filled->summary(1).all_missing, volume == empty.get());
    EXPECT_EQ(filled->summary(1).has_missing, volume == empty.get());
  }
}

TEST(FillMissing, RefusesOptionsWithoutMeaning) {
  const auto volume = test::volume_of(ScalarField(GridShape{2, 2, 2}, 2));
  NoProgress unwatched;
  const auto code = [&](FillOptions options) {
    return fill_missing(*volume, options, std::nullopt, 1, unwatched).error().code;
  };
  EXPECT_EQ(code({}), ErrorCode::invalid_argument);
  for (const double distance : {0.0, -1.0, std::nan("")})
    EXPECT_EQ(code({.method = FillMethod::linear, .max_distance = distance}), ErrorCode::invalid_argument);
}

/// Wants to stop after some questions, and remembers what was reported.
class StopAfter final : public Progress {
 public:
  explicit StopAfter(int questions) : left_(questions) {}
  void report(const char* stage, double fraction) override {
    EXPECT_STREQ(stage, "fill");
    EXPECT_GE(fraction, 0);
    EXPECT_LE(fraction, 1);
  }
  bool cancelled() const override { return left_-- <= 0; }

 private:
  mutable std::atomic<int> left_;
};

TEST(FillMissing, StopsWhereverItIsCancelled) {
  test::Random random(13);
  const auto volume = test::volume_of(test::with_holes(test::uniform_noise({70, 10, 10}, random, 0, 1), random, 0.3));
  for (int questions = 0; questions < 400; ++questions) {
    StopAfter stop(questions);
    const auto filled = fill_missing(*volume, {.method = FillMethod::linear, .max_distance = 2}, std::nullopt, 1, stop);
    if (filled) {
      EXPECT_GT(questions, 10);
      return;
    }
    EXPECT_EQ(filled.error().code, ErrorCode::cancelled);
  }
  FAIL() << "never done";
}

TEST(FillMissing, IndexesWhatItFilled) {
  test::Random random(17);
  const ScalarField field = test::with_random_gaps(test::uniform_noise({66, 20, 80}, random, 0, 1), random);
  const auto volume = test::volume_of(test::with_holes(field, random, 0.3));
  FillOptions options = kLinear;
  options.max_distance = 1.5;
  const auto filled = test::fill(*volume, options);
  const auto expected = test::volume_of(test::samples_of(*filled));
  for (std::size_t brick = 0; brick < filled->brick_count(); ++brick) {
    const BrickSummary own = filled->summary(brick), made = expected->summary(brick);
    EXPECT_EQ(own.range.min, made.range.min);
    EXPECT_EQ(own.range.max, made.range.max);
    EXPECT_EQ(own.has_missing, made.has_missing);
    EXPECT_EQ(own.all_missing, made.all_missing);
    for (std::size_t block = 0; block < kBlocksPerBrick; ++block) {
      EXPECT_EQ(filled->block_ranges(brick)[block].min, expected->block_ranges(brick)[block].min) << block;
      EXPECT_EQ(filled->block_ranges(brick)[block].max, expected->block_ranges(brick)[block].max) << block;
    }
  }
}

TEST(FillMissing, KeepsMeasuredSamplesBitForBit) {
  test::Random random(19);
  ScalarField field = test::with_holes(test::uniform_noise({70, 5, 70}, random, -1, 1), random, 0.2);
  field.at({3, 3, 3}) = -0.0f;
  const ScalarField filled = test::fill(field);
  for (std::size_t n = 0; n < field.samples.size(); ++n)
    if (!std::isnan(field.samples[n])) {
      ASSERT_EQ(std::memcmp(&field.samples[n], &filled.samples[n], sizeof(float)), 0);
    }
}

}  // namespace
}  // namespace geosis
