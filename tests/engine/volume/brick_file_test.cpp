#include "engine/volume/brick_file.h"

#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <xxhash.h>

#include "engine/volume/brick_format.h"
#include "engine/volume/brick_writer.h"
#include "tests/engine/volume/scratch_folder.h"

namespace geosis {
namespace {

constexpr GridShape kShape{3, 70, 5};

void write_ramp(const std::filesystem::path& path) {
  auto writer = BrickWriter::create(kShape, path);
  ASSERT_TRUE(writer) << writer.error().message;
  for (std::int32_t i = 0; i < kShape.inlines; ++i)
    for (std::int32_t j = 0; j < kShape.crosslines; ++j)
      writer->put(i, j, 0, std::vector<float>{0, 1, 2, static_cast<float>(i), static_cast<float>(j)});
  NoProgress unwatched;
  ASSERT_TRUE(std::move(*writer).finish(1, unwatched));
}

std::vector<char> read_file(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void write_file(const std::filesystem::path& path, const std::vector<char>& bytes) {
  std::ofstream(path, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

bool opens(const std::vector<char>& bytes) {
  return read_brick_header(std::as_bytes(std::span(bytes))).has_value();
}

TEST(BrickFile, OpensWithItsIndexAndSamples) {
  const ScratchFolder folder;
  write_ramp(folder / "ramp");
  const auto volume = open_brick_file(folder / "ramp");
  ASSERT_TRUE(volume) << volume.error().message;
  EXPECT_EQ((*volume)->shape(), kShape);
  EXPECT_EQ((*volume)->brick_count(), 2u);
  EXPECT_EQ((*volume)->summary(0).range.max, 63);
  EXPECT_EQ((*volume)->summary(1).range.max, 69);
  EXPECT_EQ((*volume)->block_ranges(0)[4].max, 32);  // crosslines 16..32
  const auto brick = (*volume)->brick(1);
  ASSERT_TRUE(brick);
  EXPECT_EQ(brick->first, (GridIndex{0, 63, 0}));
  EXPECT_EQ(brick->samples[4], 63);
}

TEST(BrickFile, KeepsTheLayoutThatItsPageDescribes) {
  const ScratchFolder folder;
  write_ramp(folder / "ramp");
  const std::vector<char> bytes = read_file(folder / "ramp");
  const auto word = [&](std::size_t at) {
    std::uint64_t value;
    std::memcpy(&value, bytes.data() + at, sizeof value);
    return value;
  };
  EXPECT_EQ(std::string(bytes.data(), 8), "GEOBRICK");
  EXPECT_EQ(word(8), (3ull << 32) | 1u);    // version 1, three sections
  EXPECT_EQ(word(16), (70ull << 32) | 3u);  // inlines, crosslines
  EXPECT_EQ(word(24), (64ull << 32) | 5u);  // samples, samples of a brick
  EXPECT_EQ(word(40), bytes.size());
  EXPECT_EQ(word(56), 1u);    // first section: summaries
  EXPECT_EQ(word(64), 192u);  // at
  EXPECT_EQ(word(72), 48u);   // bytes
  EXPECT_EQ(word(120), 3u);   // third section: samples
  EXPECT_EQ(word(128), 4096u);
  EXPECT_EQ(bytes.size(), 4096u + 3 * 71 * 5 * 4);
}

TEST(BrickFile, NamesADamagedBrick) {
  const ScratchFolder folder;
  write_ramp(folder / "ramp");
  std::vector<char> bytes = read_file(folder / "ramp");
  bytes.back() = static_cast<char>(bytes.back() ^ 1);
  write_file(folder / "damaged", bytes);
  const auto volume = open_brick_file(folder / "damaged");
  ASSERT_TRUE(volume) << volume.error().message;
  EXPECT_TRUE((*volume)->brick(0));
  for (int touch = 0; touch < 2; ++touch) {
    const auto brick = (*volume)->brick(1);
    ASSERT_FALSE(brick);
    EXPECT_EQ(brick.error().code, ErrorCode::malformed_input);
    EXPECT_NE(brick.error().message.find("brick 1 at (0, 1, 0)"), std::string::npos) << brick.error().message;
  }
}

TEST(BrickFile, RefusesEveryChangedByteBeforeTheSamples) {
  const ScratchFolder folder;
  write_ramp(folder / "ramp");
  std::vector<char> bytes = read_file(folder / "ramp");
  constexpr std::size_t index_end = 256 + 2 * 512;
  for (std::size_t at = 0; at < index_end; at += at < 200 ? 1 : 13) {
    const bool padding = (at >= 152 && at < 192) || (at >= 240 && at < 256);
    if (padding) continue;
    bytes[at] = static_cast<char>(bytes[at] ^ 0x10);
    EXPECT_FALSE(opens(bytes)) << "byte " << at;
    bytes[at] = static_cast<char>(bytes[at] ^ 0x10);
  }
}

TEST(BrickFile, RefusesToBeCutShortOrEmpty) {
  const ScratchFolder folder;
  write_ramp(folder / "ramp");
  const std::vector<char> bytes = read_file(folder / "ramp");
  for (const std::size_t size : {std::size_t{0}, std::size_t{1}, std::size_t{55}, std::size_t{100}, bytes.size() - 1}) {
    write_file(folder / "cut", {bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size)});
    const auto volume = open_brick_file(folder / "cut");
    ASSERT_FALSE(volume) << size;
    EXPECT_EQ(volume.error().code, ErrorCode::malformed_input);
  }
  EXPECT_EQ(open_brick_file(folder / "absent").error().code, ErrorCode::not_found);
}

/// A header whose checksum is right and whose contents are hostile.
std::vector<char> forged(std::vector<char> bytes, std::size_t at, std::uint64_t value) {
  std::memcpy(bytes.data() + at, &value, sizeof value);
  std::memset(bytes.data() + 48, 0, 8);
  const std::uint64_t checksum = XXH3_64bits(bytes.data(), 152);
  std::memcpy(bytes.data() + 48, &checksum, sizeof checksum);
  return bytes;
}

TEST(BrickFile, RefusesForgedOffsetsSizesAndShapes) {
  const ScratchFolder folder;
  write_ramp(folder / "ramp");
  const std::vector<char> bytes = read_file(folder / "ramp");
  ASSERT_TRUE(opens(forged(bytes, 64, 192)));  // the forger works
  const std::uint64_t huge = ~std::uint64_t{0};
  for (const auto& [at, value] : std::vector<std::pair<std::size_t, std::uint64_t>>{{64, huge},
                                                                                    {64, huge - 40},
                                                                                    {72, huge},
                                                                                    {128, huge},
                                                                                    {136, huge},
                                                                                    {128, 4090},
                                                                                    {16, 0},
                                                                                    {16, huge},
                                                                                    {16, (131071ull << 32) | 131071u},
                                                                                    {24, (64ull << 32) | 131071u},
                                                                                    {120, 7}}) {
    EXPECT_FALSE(opens(forged(bytes, at, value))) << "word at " << at << " = " << value;
  }
}

TEST(BrickFile, RefusesAHeaderWithoutSections) {
  const ScratchFolder folder;
  write_ramp(folder / "ramp");
  EXPECT_FALSE(opens(forged(read_file(folder / "ramp"), 8, 1)));  // version 1, no sections
}

TEST(BrickFile, LeavesNothingBehindWhenCancelledOrAbandoned) {
  class Cancelled final : public Progress {
   public:
    void report(const char*, double) override {}
    bool cancelled() const override { return true; }
  } cancelled;
  const ScratchFolder folder;
  {
    auto writer = BrickWriter::create(kShape, folder / "volume");
    ASSERT_TRUE(writer);
    EXPECT_FALSE(folder.is_empty());
    EXPECT_EQ(std::move(*writer).finish(1, cancelled).error().code, ErrorCode::cancelled);
  }
  EXPECT_TRUE(folder.is_empty());
}

TEST(BrickFile, ReportsAFullDiskBeforeWriting) {
  const ScratchFolder folder;
  // 2^17 x 2^17 x 2^17 samples: 9 PB, more than a file may have.
  const auto too_big = BrickWriter::create({kMaxAxisNodes, kMaxAxisNodes, kMaxAxisNodes}, folder / "volume");
  ASSERT_FALSE(too_big);
  EXPECT_EQ(too_big.error().code, ErrorCode::no_space) << too_big.error().message;
  EXPECT_TRUE(folder.is_empty());
}

TEST(MakeBrickedVolume, TakesInfiniteSamplesAsMissing) {
  std::vector<float> samples(8, 2.0f);
  samples[3] = std::numeric_limits<float>::infinity();
  const auto volume = make_bricked_volume({2, 2, 2}, samples);
  EXPECT_TRUE(volume->summary(0).has_missing);
  EXPECT_EQ(volume->summary(0).range.max, 2);
  EXPECT_TRUE(std::isnan(volume->brick(0)->samples[3]));
}

}  // namespace
}  // namespace geosis
