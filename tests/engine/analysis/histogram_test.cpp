#include "engine/analysis/histogram.h"

#include <algorithm>
#include <atomic>
#include <limits>
#include <memory>
#include <numeric>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "engine/volume/brick_file.h"

namespace geosis {
namespace {

constexpr float kMissing = std::numeric_limits<float>::quiet_NaN();
constexpr GridShape kShape = {70, 66, 130};  // 2 x 2 x 3 bricks, the last ones clipped

std::vector<float> random_samples(unsigned seed, float scale) {
  std::mt19937 random(seed);
  std::vector<float> samples(static_cast<std::size_t>(kShape.count()));
  for (float& value : samples) {
    const bool missing = random() % 9 == 0;
    value = missing ? kMissing : (static_cast<float>(random() % 10'001) / 5000 - 1) * scale;
  }
  return samples;
}

Histogram histogram_of(GridShape shape, const std::vector<float>& samples, int bins, int threads = 1) {
  NoProgress unwatched;
  return count_values(*make_bricked_volume(shape, samples), bins, threads, unwatched).value();
}

/// What the edges say, one sample at a time.
Histogram counted_by_edges(const std::vector<double>& edges, const std::vector<float>& samples) {
  Histogram histogram{edges, std::vector<std::int64_t>(edges.size() - 1), 0};
  for (const float value : samples) {
    if (value != value) {
      ++histogram.missing;
      continue;
    }
    const auto above = std::upper_bound(edges.begin(), edges.end(), value) - edges.begin();
    const auto bin = std::min<std::ptrdiff_t>(above - 1, static_cast<std::ptrdiff_t>(edges.size()) - 2);
    ++histogram.counts.at(static_cast<std::size_t>(bin));
  }
  return histogram;
}

TEST(CountValues, CountsEveryNodeOnceInTheBinOfItsEdges) {
  for (const float scale : {1.0f, 3e38f, 1e-42f, 12'345.678f})
    for (const int bins : {1, 7, 256, 4096}) {
      SCOPED_TRACE(testing::Message() << "scale " << scale << " bins " << bins);
      const auto samples = random_samples(11, scale);
      const Histogram histogram = histogram_of(kShape, samples, bins);
      const Histogram expected = counted_by_edges(histogram.edges, samples);
      EXPECT_EQ(histogram.counts, expected.counts);
      EXPECT_EQ(histogram.missing, expected.missing);
      EXPECT_EQ(std::accumulate(histogram.counts.begin(), histogram.counts.end(), histogram.missing), kShape.count());
    }
}

TEST(CountValues, EdgesAreEquallySpacedFromTheSmallestToTheLargestSample) {
  const Histogram histogram = histogram_of({1, 1, 6}, {-2, kMissing, 0, 1.5f, 6, 6}, 4);
  EXPECT_EQ(histogram.edges, (std::vector<double>{-2, 0, 2, 4, 6}));
  EXPECT_EQ(histogram.counts, (std::vector<std::int64_t>{1, 2, 0, 2}));
  EXPECT_EQ(histogram.missing, 1);
}

TEST(CountValues, SeparatesNeighbouringFloatsFarFromZero) {
  const float low = 1e6f;
  const std::vector<float> samples = {low, low + 0.0625f, low + 0.125f, low + 0.1875f};
  const Histogram histogram = histogram_of({1, 1, 4}, samples, 3);
  EXPECT_EQ(histogram.counts, counted_by_edges(histogram.edges, samples).counts);
  EXPECT_EQ(std::accumulate(histogram.counts.begin(), histogram.counts.end(), std::int64_t{0}), 4);
}

TEST(CountValues, OneValueLiesInTheMiddleOfAscendingEdges) {
  for (const float value : {0.0f, -7.25f, 1e20f, -std::numeric_limits<float>::max()}) {
    const Histogram histogram = histogram_of({1, 2, 2}, {value, value, kMissing, value}, 4096);
    EXPECT_EQ(histogram.counts[2048], 3) << value;
    EXPECT_EQ(histogram.missing, 1);
    EXPECT_TRUE(std::is_sorted(histogram.edges.begin(), histogram.edges.end(), std::less_equal<>())) << value;
  }
}

TEST(CountValues, VolumeWithoutValidSamplesHasOnlyMissingOnes) {
  const Histogram histogram = histogram_of({3, 70, 2}, std::vector<float>(420, kMissing), 2);
  EXPECT_EQ(histogram.edges, (std::vector<double>{0, 0.5, 1}));
  EXPECT_EQ(histogram.counts, (std::vector<std::int64_t>{0, 0}));
  EXPECT_EQ(histogram.missing, 420);
}

TEST(CountValues, SharedLayersOfBricksWithoutValidSamplesCountOnce) {
  std::vector<float> samples(2 * 2 * 190, kMissing);
  samples[0] = 1;
  const Histogram histogram = histogram_of({2, 2, 190}, samples, 1);
  EXPECT_EQ(histogram.counts, std::vector<std::int64_t>{1});
  EXPECT_EQ(histogram.missing, 759);
}

TEST(CountValues, IsTheSameForAnyThreadCount) {
  const auto samples = random_samples(12, 1);
  const Histogram alone = histogram_of(kShape, samples, 512);
  for (const int threads : {2, 3, 16}) EXPECT_EQ(histogram_of(kShape, samples, 512, threads).counts, alone.counts);
}

TEST(CountValues, RejectsBinsOutsideTheirLimits) {
  const auto volume = make_bricked_volume({1, 1, 2}, std::vector<float>{1, 2});
  NoProgress unwatched;
  for (const int bins : {0, -1, 4097}) {
    const auto histogram = count_values(*volume, bins, 1, unwatched);
    ASSERT_FALSE(histogram);
    EXPECT_EQ(histogram.error().code, ErrorCode::invalid_argument);
    EXPECT_EQ(histogram.error().message, "histogram of " + std::to_string(bins) + " bins; expected 1..4096");
  }
}

/// Cancels after some reports.
class Impatient final : public Progress {
 public:
  explicit Impatient(int patience) : patience_(patience) {}
  void report(const char*, double fraction) override {
    --patience_;
    last_fraction = fraction;
  }
  bool cancelled() const override { return patience_ <= 0; }
  std::atomic<double> last_fraction{0};

 private:
  std::atomic<int> patience_;
};

TEST(CountValues, StopsBetweenBricksWhenCancelled) {
  const auto volume = make_bricked_volume(kShape, random_samples(13, 1));
  Impatient impatient(3);
  const auto histogram = count_values(*volume, 16, 1, impatient);
  ASSERT_FALSE(histogram);
  EXPECT_EQ(histogram.error().code, ErrorCode::cancelled);
  EXPECT_EQ(impatient.last_fraction, 3.0 / 12);
}

TEST(CountValues, ReportsProgressUpToTheEnd) {
  Impatient watching(100);
  ASSERT_TRUE(count_values(*make_bricked_volume(kShape, random_samples(14, 1)), 16, 1, watching));
  EXPECT_EQ(watching.last_fraction, 1);
}

/// One brick whose summary and samples may be anything, as in a file that was made to deceive.
class Deceiving final : public BrickedVolume {
 public:
  Deceiving(ValueRange range, std::vector<float> samples) : range_(range), samples_(std::move(samples)) {}
  GridShape shape() const override { return {1, 1, static_cast<std::int32_t>(samples_.size())}; }
  GridShape brick_grid() const override { return {1, 1, 1}; }
  std::size_t brick_count() const override { return 1; }
  BrickSummary summary(std::size_t) const override { return {range_, false, false}; }
  std::span<const ValueRange, kBlocksPerBrick> block_ranges(std::size_t) const override { return blocks_; }
  Result<BrickView> brick(std::size_t) const override { return BrickView{samples_.data(), {}, shape()}; }

 private:
  ValueRange range_;
  std::vector<float> samples_;
  std::array<ValueRange, kBlocksPerBrick> blocks_{};
};

TEST(CountValues, PutsSamplesBeyondTheSummaryIntoTheOuterBins) {
  NoProgress unwatched;
  constexpr float infinity = std::numeric_limits<float>::infinity();
  const auto histogram =
      count_values(Deceiving({0, 4}, {-infinity, -1e30f, 2, 4, 1e30f, infinity, kMissing}), 4, 1, unwatched);
  ASSERT_TRUE(histogram);
  EXPECT_EQ(histogram->counts, (std::vector<std::int64_t>{2, 0, 1, 3}));
  EXPECT_EQ(histogram->missing, 1);
}

TEST(CountValues, RejectsSummariesThatAreNotNumbers) {
  NoProgress unwatched;
  for (const ValueRange range : {ValueRange{kMissing, 1}, ValueRange{0, std::numeric_limits<float>::infinity()}}) {
    const auto histogram = count_values(Deceiving(range, {1, 2}), 4, 1, unwatched);
    ASSERT_FALSE(histogram);
    EXPECT_EQ(histogram.error().code, ErrorCode::malformed_input);
  }
}

}  // namespace
}  // namespace geosis
