// Law: whatever the shape, the order of writing and the missing samples, the bricks hold exactly the volume's samples.

#include <algorithm>
#include <cstring>
#include <limits>
#include <memory>
#include <numeric>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "engine/volume/brick_file.h"
#include "engine/volume/brick_writer.h"
#include "engine/volume/trace_order_writer.h"

namespace geosis {
namespace {

/// Bit for bit, so that NaN equals NaN.
bool same_bits(float a, float b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

struct RandomVolume {
  GridShape shape;
  std::vector<float> samples;
};

RandomVolume random_volume(std::mt19937& random) {
  const auto axis = [&] {
    return static_cast<std::int32_t>(random() % 4 == 0 ? 60 + random() % 75 : 2 + random() % 20);
  };
  RandomVolume volume{{axis(), axis(), axis()}, {}};
  volume.samples.resize(static_cast<std::size_t>(volume.shape.count()));
  const unsigned missing_in = 1 + static_cast<unsigned>(random() % 50);
  for (float& value : volume.samples)
    value = random() % missing_in == 0 ? std::numeric_limits<float>::quiet_NaN() : static_cast<float>(random()) - 2e9f;
  return volume;
}

void expect_holds(const BrickedVolume& bricks, const RandomVolume& volume) {
  const GridShape& shape = volume.shape;
  ASSERT_EQ(bricks.shape(), shape);
  std::vector<int> seen(volume.samples.size());
  std::int64_t wrong = 0;
  for (std::size_t brick = 0; brick < bricks.brick_count(); ++brick) {
    const auto view = bricks.brick(brick);
    ASSERT_TRUE(view) << view.error().message;
    const float* sample = view->samples;
    for (std::int32_t a = 0; a < view->extent.inlines; ++a)
      for (std::int32_t b = 0; b < view->extent.crosslines; ++b)
        for (std::int32_t c = 0; c < view->extent.samples; ++c, ++sample) {
          const std::int64_t i = view->first.i + a, j = view->first.j + b, k = view->first.k + c;
          const auto at = static_cast<std::size_t>((i * shape.crosslines + j) * shape.samples + k);
          wrong += !same_bits(*sample, volume.samples[at]);
          ++seen[at];
        }
  }
  EXPECT_EQ(wrong, 0);
  EXPECT_EQ(std::count(seen.begin(), seen.end(), 0), 0);
}

TEST(Bricks, ReassembleTheSamplesOfRandomVolumes) {
  for (unsigned seed = 1; seed <= 25; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937 random(seed);
    const RandomVolume volume = random_volume(random);
    expect_holds(*make_bricked_volume(volume.shape, volume.samples), volume);
  }
}

TEST(Bricks, HoldPartsOfTracesWrittenInAnyOrder) {
  for (unsigned seed = 101; seed <= 115; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937 random(seed);
    const RandomVolume volume = random_volume(random);
    const GridShape& shape = volume.shape;
    auto writer = BrickWriter::create(shape, std::nullopt);
    ASSERT_TRUE(writer) << writer.error().message;
    std::vector<std::int64_t> traces(static_cast<std::size_t>(shape.inlines) *
                                     static_cast<std::size_t>(shape.crosslines));
    std::iota(traces.begin(), traces.end(), 0);
    std::shuffle(traces.begin(), traces.end(), random);
    for (const std::int64_t trace : traces)
      for (std::int32_t k = 0, count = 0; k < shape.samples; k += count) {
        count = std::min<std::int32_t>(1 + static_cast<std::int32_t>(random() % 90), shape.samples - k);
        writer->put(static_cast<std::int32_t>(trace / shape.crosslines),
                    static_cast<std::int32_t>(trace % shape.crosslines), k,
                    std::span(volume.samples)
                        .subspan(static_cast<std::size_t>(trace * shape.samples + k), static_cast<std::size_t>(count)));
      }
    NoProgress unwatched;
    const auto bricks = std::move(*writer).finish(2, unwatched);
    ASSERT_TRUE(bricks) << bricks.error().message;
    expect_holds(**bricks, volume);
  }
}

void expect_same_index(const BrickedVolume& bricks, const BrickedVolume& expected) {
  for (std::size_t brick = 0; brick < bricks.brick_count(); ++brick) {
    const BrickSummary a = bricks.summary(brick), b = expected.summary(brick);
    EXPECT_TRUE(same_bits(a.range.min, b.range.min) && same_bits(a.range.max, b.range.max)) << "brick " << brick;
    EXPECT_EQ(a.has_missing, b.has_missing) << "brick " << brick;
    EXPECT_EQ(a.all_missing, b.all_missing) << "brick " << brick;
    EXPECT_EQ(std::memcmp(bricks.block_ranges(brick).data(), expected.block_ranges(brick).data(), kBlockRangeBytes), 0)
        << "brick " << brick;
  }
}

TEST(Bricks, HoldTracesWrittenInOrderInPiecesOfAnyLength) {
  for (unsigned seed = 201; seed <= 220; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937 random(seed);
    const RandomVolume volume = random_volume(random);
    const GridShape& shape = volume.shape;
    auto writer = BrickWriter::create(shape, std::nullopt);
    ASSERT_TRUE(writer) << writer.error().message;
    TraceOrderWriter traces(*writer);
    for (std::int32_t column = 0; column < traces.columns(); ++column) {
      const std::int32_t begin = traces.first_crossline(column), crosslines = traces.crosslines(column);
      for (std::int32_t row = 0, count = 0; row < shape.inlines * crosslines; row += count) {
        count = std::min<std::int32_t>(1 + static_cast<std::int32_t>(random() % 200), shape.inlines * crosslines - row);
        std::vector<const float*> pointers;
        for (std::int32_t r = row; r < row + count; ++r) {
          const std::int64_t trace = std::int64_t{r / crosslines} * shape.crosslines + begin + r % crosslines;
          pointers.push_back(volume.samples.data() + trace * shape.samples);
        }
        ASSERT_TRUE(traces.put(column, row / crosslines, begin + row % crosslines, pointers));
      }
    }
    NoProgress unwatched;
    const auto bricks = std::move(*writer).finish(2, unwatched);
    ASSERT_TRUE(bricks) << bricks.error().message;
    expect_holds(**bricks, volume);
    expect_same_index(**bricks, *make_bricked_volume(shape, volume.samples));
  }
}

}  // namespace
}  // namespace geosis
