// Which header words make the grid, and what happens when none or several do.

#include <cmath>
#include <numeric>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "tests/engine/volume/formats/segy_bytes.h"

namespace geosis {
namespace {

constexpr std::size_t kTraceBytes = 240 + 3 * 2;

/// The file with its traces in another order.
std::vector<std::byte> shuffled(const std::vector<std::byte>& bytes, unsigned seed) {
  std::vector<std::size_t> order((bytes.size() - 3600) / kTraceBytes);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::shuffle(order.begin(), order.end(), std::mt19937(seed));
  std::vector<std::byte> result(bytes.begin(), bytes.begin() + 3600);
  for (const std::size_t trace : order) {
    const auto first = bytes.begin() + static_cast<std::ptrdiff_t>(3600 + trace * kTraceBytes);
    result.insert(result.end(), first, first + static_cast<std::ptrdiff_t>(kTraceBytes));
  }
  return result;
}

/// The file without one of its traces.
std::vector<std::byte> without_trace(std::vector<std::byte> bytes, std::size_t trace) {
  const auto first = bytes.begin() + static_cast<std::ptrdiff_t>(3600 + trace * kTraceBytes);
  bytes.erase(first, first + static_cast<std::ptrdiff_t>(kTraceBytes));
  return bytes;
}

void expect_small_survey(const Result<ImportedVolume>& volume) {
  ASSERT_TRUE(volume) << volume.error().message;
  EXPECT_EQ(volume->description.shape, (GridShape{4, 3, 3}));
  EXPECT_EQ(volume->description.inline_axis.first, 10);
  EXPECT_EQ(volume->description.inline_axis.step, 2);
  EXPECT_EQ(volume->description.crossline_axis.first, 295);
  EXPECT_EQ(volume->description.crossline_axis.step, 5);
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 3; ++k) EXPECT_EQ(sample_at(*volume, i, j, k), static_cast<float>(100 * i + 10 * j + k));
}

TEST(FindGrid, FindsTheUsualWordsInBothByteOrders) {
  for (const auto& [inline_byte, crossline_byte] :
       {std::pair{189, 193}, {5, 21}, {9, 21}, {9, 13}, {17, 25}, {221, 225}, {181, 185}})
    for (const bool big_endian : {true, false}) {
      SCOPED_TRACE(testing::Message() << inline_byte << "/" << crossline_byte << (big_endian ? " big" : " little"));
      const auto volume = import_bytes(small_survey(4, 3, inline_byte, crossline_byte, big_endian).bytes());
      expect_small_survey(volume);
      EXPECT_EQ(volume->description.inline_axis.byte, inline_byte);
      EXPECT_EQ(volume->description.options.crossline_byte, crossline_byte);
      EXPECT_EQ(volume->description.options.byte_order, big_endian ? ByteOrder::big : ByteOrder::little);
    }
}

TEST(FindGrid, TakesTracesInAnyOrder) {
  for (const unsigned seed : {1u, 2u, 3u})
    expect_small_survey(import_bytes(shuffled(small_survey(4, 3).bytes(), seed)));
}

TEST(FindGrid, TakesWordsAndWidthsFromTheOptions) {
  SegyBytes file(3, 3, 2);
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 3; ++j) {
      file.trace().word<std::int16_t>(233, static_cast<std::int16_t>(10 + 2 * i));
      file.word<std::int16_t>(235, static_cast<std::int16_t>(295 + 5 * j));
      for (int k = 0; k < 3; ++k)
        file.sample(static_cast<std::size_t>(k), static_cast<std::int16_t>(100 * i + 10 * j + k));
    }
  EXPECT_FALSE(import_bytes(file.bytes()));
  expect_small_survey(
      import_bytes(file.bytes(), {.inline_byte = 233, .crossline_byte = 235, .inline_width = 2, .crossline_width = 2}));
}

TEST(FindGrid, RefusesWordsOutsideTheTraceHeader) {
  const auto bytes = small_survey(4, 3).bytes();
  for (const int byte : {-1, 0, 238, 1 << 30}) {
    EXPECT_EQ(import_bytes(bytes, {.inline_byte = byte}).error().code, ErrorCode::invalid_argument) << byte;
    EXPECT_EQ(import_bytes(bytes, {.crossline_byte = byte}).error().code, ErrorCode::invalid_argument) << byte;
    EXPECT_EQ(import_bytes(bytes, {.x_byte = byte}).error().code, ErrorCode::invalid_argument) << byte;
  }
  EXPECT_EQ(import_bytes(bytes, {.inline_width = 3}).error().code, ErrorCode::invalid_argument);
  EXPECT_EQ(import_bytes(bytes, {.inline_byte = 9, .crossline_byte = 9}).error().code, ErrorCode::invalid_argument);
}

TEST(FindGrid, CountsTheSameGridInSeveralWordsOnce) {
  SegyBytes file(3, 2, 2);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 4; ++j) file.trace().word(5, 7 + i).word(9, 7 + i).word(21, 50 + j).word(13, 1 + j);
  const auto volume = import_bytes(file.bytes());
  ASSERT_TRUE(volume) << volume.error().message;
  EXPECT_EQ(volume->description.inline_axis.byte, 5);
  EXPECT_EQ(volume->description.crossline_axis.byte, 21);
}

TEST(FindGrid, NamesTheCandidatesWhenWordsDisagree) {
  SegyBytes file(3, 2, 2);
  for (int t = 0; t < 12; ++t) file.trace().word(189, t / 3).word(193, t % 3).word(9, t / 4).word(21, t % 4);
  std::vector<GridCandidate> candidates;
  const auto volume = import_bytes(file.bytes(), {}, &candidates);
  ASSERT_FALSE(volume);
  EXPECT_EQ(volume.error().code, ErrorCode::malformed_input);
  EXPECT_NE(volume.error().message.find("189/193 (4 x 3, 0 missing), 9/21 (3 x 4, 0 missing)"), std::string::npos)
      << volume.error().message;
  ASSERT_EQ(candidates.size(), 2u);
  EXPECT_EQ(candidates[0].inline_byte, 189);
  EXPECT_EQ(candidates[0].shape, (GridShape{4, 3, 2}));
  EXPECT_EQ(candidates[1].crossline_byte, 21);
  const auto chosen = import_bytes(file.bytes(), {.inline_byte = 9, .crossline_byte = 21});
  ASSERT_TRUE(chosen) << chosen.error().message;
  EXPECT_EQ(chosen->description.shape, (GridShape{3, 4, 2}));
}

TEST(FindGrid, LeavesAbsentTracesMissing) {
  const auto volume = import_bytes(without_trace(small_survey(4, 3).bytes(), 4));  // i = 1, j = 1
  ASSERT_TRUE(volume) << volume.error().message;
  EXPECT_EQ(volume->description.missing_traces, 1);
  EXPECT_EQ(volume->description.missing_samples, 3);
  EXPECT_TRUE(std::isnan(sample_at(*volume, 1, 1, 0)));
  EXPECT_EQ(sample_at(*volume, 1, 2, 0), 120);
}

TEST(FindGrid, RefusesNumbersThatWouldFillTheDisk) {
  SegyBytes file(3, 2, 2);
  for (const int i : {0, 1, 100000})
    for (const int j : {0, 1, 100000}) file.trace().word(189, i).word(193, j);
  const auto found = import_bytes(file.bytes());
  ASSERT_FALSE(found);
  const auto named = import_bytes(file.bytes(), {.inline_byte = 189, .crossline_byte = 193});
  ASSERT_FALSE(named);
  EXPECT_EQ(named.error().code, ErrorCode::limit_exceeded);
  EXPECT_NE(named.error().message.find("100001 x 100001"), std::string::npos) << named.error().message;
}

TEST(FindGrid, SurvivesNumbersAtTheEndsOfTheirRange) {
  SegyBytes file(3, 2, 2);
  for (const std::int32_t i : {INT32_MIN, INT32_MAX})
    for (const std::int32_t j : {INT32_MIN, INT32_MAX}) file.trace().word(189, i).word(193, j);
  const auto volume = import_bytes(file.bytes());
  ASSERT_TRUE(volume) << volume.error().message;
  EXPECT_EQ(volume->description.shape, (GridShape{2, 2, 2}));
  EXPECT_EQ(volume->description.inline_axis.step, 4294967295.0);
}

TEST(Duplicates, AreTakenAsTheOptionSays) {
  SegyBytes file = small_survey(3, 3);
  for (const std::int16_t value : {std::int16_t{1000}, std::int16_t{2003}}) {
    file.trace().word(189, 12).word(193, 300);  // i = 1, j = 1, whose samples are 110, 111, 112
    for (std::size_t k = 0; k < 3; ++k) file.sample(k, value);
  }
  const auto rejected = import_bytes(file.bytes());
  ASSERT_FALSE(rejected);
  EXPECT_EQ(rejected.error().code, ErrorCode::malformed_input);
  EXPECT_NE(rejected.error().message.find("2 of 11 traces share the position"), std::string::npos);
  const auto value = [&](DuplicateTraces duplicates) {
    const auto volume = import_bytes(file.bytes(), {.duplicates = duplicates});
    EXPECT_TRUE(volume) << volume.error().message;
    EXPECT_EQ(sample_at(*volume, 2, 2, 1), 221);
    EXPECT_EQ(volume->description.missing_samples, 0);
    return sample_at(*volume, 1, 1, 1);
  };
  EXPECT_EQ(value(DuplicateTraces::first), 111);
  EXPECT_EQ(value(DuplicateTraces::last), 2003);
  EXPECT_EQ(value(DuplicateTraces::mean), 1038);
}

TEST(Refusal, NamesALineOfTracesInBothWords) {
  SegyBytes crooked(3, 2, 2), straight(3, 2, 2);
  for (int t = 0; t < 40; ++t) {
    crooked.trace().word(5, t).word(21, 100 + t);
    straight.trace().word(189, 7).word(193, t);
  }
  for (SegyBytes* file : {&crooked, &straight}) {
    const auto volume = import_bytes(file->bytes());
    ASSERT_FALSE(volume);
    EXPECT_EQ(volume.error().code, ErrorCode::unsupported);
    EXPECT_NE(volume.error().message.find("2D line"), std::string::npos) << volume.error().message;
  }
}

}  // namespace
}  // namespace geosis
