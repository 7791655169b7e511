#include "engine/volume/slice.h"

#include <cstring>
#include <limits>
#include <memory>
#include <random>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "engine/volume/brick_file.h"

namespace geosis {
namespace {

constexpr GridShape kShape = {70, 66, 130};  // 2 x 2 x 3 bricks, the last ones clipped

std::vector<float> random_samples(GridShape shape) {
  std::mt19937 random(7);
  std::vector<float> samples(static_cast<std::size_t>(shape.count()));
  for (float& value : samples)
    value = random() % 9 == 0 ? std::numeric_limits<float>::quiet_NaN() : static_cast<float>(random() % 100'000) - 5e4f;
  return samples;
}

/// The node that a pixel shows.
GridIndex node_at(SliceAxis axis, std::int32_t index, std::int32_t row, std::int32_t column) {
  if (axis == SliceAxis::inline_) return {index, column, row};
  if (axis == SliceAxis::crossline) return {column, index, row};
  return {row, column, index};
}

/// Every pixel bit for bit, so that NaN equals NaN.
void expect_slice(const BrickedVolume& volume, const std::vector<float>& samples, SliceAxis axis, std::int32_t index) {
  SCOPED_TRACE(testing::Message() << "axis " << static_cast<int>(axis) << " index " << index);
  const auto slice = read_slice(volume, axis, index);
  ASSERT_TRUE(slice) << slice.error().message;
  ASSERT_EQ(slice->samples.size(), static_cast<std::size_t>(slice->rows) * static_cast<std::size_t>(slice->columns));
  const GridShape shape = volume.shape();
  int wrong = 0;
  const float* pixel = slice->samples.data();
  for (std::int32_t row = 0; row < slice->rows; ++row)
    for (std::int32_t column = 0; column < slice->columns; ++column, ++pixel) {
      const GridIndex node = node_at(axis, index, row, column);
      const std::int64_t at = (std::int64_t{node.i} * shape.crosslines + node.j) * shape.samples + node.k;
      wrong += std::memcmp(pixel, &samples[static_cast<std::size_t>(at)], sizeof *pixel) != 0;
    }
  EXPECT_EQ(wrong, 0);
}

TEST(ReadSlice, ShowsEveryNodeOfEveryPlane) {
  const auto samples = random_samples(kShape);
  const auto volume = make_bricked_volume(kShape, samples);
  for (std::int32_t i = 0; i < kShape.inlines; ++i) expect_slice(*volume, samples, SliceAxis::inline_, i);
  for (std::int32_t j = 0; j < kShape.crosslines; ++j) expect_slice(*volume, samples, SliceAxis::crossline, j);
  for (std::int32_t k = 0; k < kShape.samples; ++k) expect_slice(*volume, samples, SliceAxis::sample, k);
}

TEST(ReadSlice, LaysSectionsOutWithTimeDownwardsAndTimeSlicesAsAMap) {
  const auto volume = make_bricked_volume(kShape, random_samples(kShape));
  const auto shape_of = [&](SliceAxis axis) {
    const Slice slice = read_slice(*volume, axis, 3).value();
    return std::pair(slice.rows, slice.columns);
  };
  EXPECT_EQ(shape_of(SliceAxis::inline_), std::pair(130, 66));
  EXPECT_EQ(shape_of(SliceAxis::crossline), std::pair(130, 70));
  EXPECT_EQ(shape_of(SliceAxis::sample), std::pair(70, 66));
}

TEST(ReadSlice, ReadsAxesThatEndWithABrickOrHaveOneNode) {
  for (const GridShape shape : {GridShape{64, 65, 127}, GridShape{1, 128, 1}, GridShape{1, 1, 1}}) {
    const auto samples = random_samples(shape);
    const auto volume = make_bricked_volume(shape, samples);
    for (const auto axis : {SliceAxis::inline_, SliceAxis::crossline, SliceAxis::sample})
      for (const std::int32_t index : {0, shape[static_cast<int>(axis)] - 1})
        expect_slice(*volume, samples, axis, index);
  }
}

/// A volume that remembers which of its bricks were read.
class Watched final : public BrickedVolume {
 public:
  explicit Watched(std::unique_ptr<BrickedVolume> volume) : volume_(std::move(volume)) {}
  GridShape shape() const override { return volume_->shape(); }
  GridShape brick_grid() const override { return volume_->brick_grid(); }
  std::size_t brick_count() const override { return volume_->brick_count(); }
  BrickSummary summary(std::size_t brick) const override { return volume_->summary(brick); }
  std::span<const ValueRange, kBlocksPerBrick> block_ranges(std::size_t brick) const override {
    return volume_->block_ranges(brick);
  }
  Result<BrickView> brick(std::size_t brick) const override {
    read.push_back(brick);
    return brick == damaged ? Error{ErrorCode::malformed_input, "brick is damaged"} : volume_->brick(brick);
  }

  mutable std::vector<std::size_t> read;
  std::size_t damaged = std::numeric_limits<std::size_t>::max();

 private:
  std::unique_ptr<BrickedVolume> volume_;
};

TEST(ReadSlice, ReadsOnlyTheBricksItCrosses) {
  const Watched volume(make_bricked_volume(kShape, random_samples(kShape)));
  ASSERT_TRUE(read_slice(volume, SliceAxis::inline_, 69));
  EXPECT_EQ(volume.read, (std::vector<std::size_t>{6, 7, 8, 9, 10, 11}));
  volume.read.clear();
  ASSERT_TRUE(read_slice(volume, SliceAxis::sample, 100));
  EXPECT_EQ(volume.read, (std::vector<std::size_t>{1, 4, 7, 10}));
}

TEST(ReadSlice, PassesOnThatABrickIsDamaged) {
  Watched volume(make_bricked_volume(kShape, random_samples(kShape)));
  volume.damaged = 7;
  EXPECT_TRUE(read_slice(volume, SliceAxis::inline_, 0));
  const auto slice = read_slice(volume, SliceAxis::inline_, 69);
  ASSERT_FALSE(slice);
  EXPECT_EQ(slice.error().code, ErrorCode::malformed_input);
}

TEST(ReadSlice, RejectsAnIndexOutsideTheAxis) {
  const auto volume = make_bricked_volume({2, 3, 4}, std::vector<float>(24));
  const auto message = [&](SliceAxis axis, std::int32_t index) {
    const auto slice = read_slice(*volume, axis, index);
    if (slice) return std::string("no error");
    EXPECT_EQ(slice.error().code, ErrorCode::invalid_argument);
    return slice.error().message;
  };
  EXPECT_EQ(message(SliceAxis::inline_, 2), "inline slice 2; expected a node number, 0..1");
  EXPECT_EQ(message(SliceAxis::crossline, -1), "crossline slice -1; expected a node number, 0..2");
  EXPECT_EQ(message(SliceAxis::sample, std::numeric_limits<std::int32_t>::max()),
            "sample slice 2147483647; expected a node number, 0..3");
}

/// A huge volume whose samples nobody may read.
class Huge final : public BrickedVolume {
 public:
  GridShape shape() const override { return {100'000, 100'000, 1}; }
  GridShape brick_grid() const override { return {1588, 1588, 1}; }
  std::size_t brick_count() const override { return std::size_t{1588} * 1588; }
  BrickSummary summary(std::size_t) const override { return {}; }
  std::span<const ValueRange, kBlocksPerBrick> block_ranges(std::size_t) const override { return ranges_; }
  Result<BrickView> brick(std::size_t) const override { return Error{ErrorCode::internal, "was read"}; }

 private:
  std::array<ValueRange, kBlocksPerBrick> ranges_{};
};

TEST(ReadSlice, RefusesHugeSlicesBeforeItReservesMemory) {
  const auto slice = read_slice(Huge(), SliceAxis::sample, 0);
  ASSERT_FALSE(slice);
  EXPECT_EQ(slice.error().code, ErrorCode::limit_exceeded);
  EXPECT_EQ(slice.error().message, "sample slice of 100000 x 100000 samples; the limit is 67108864");
}

}  // namespace
}  // namespace geosis
