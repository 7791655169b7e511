// Samples, missing values, the sample axis and the text header.

#include <bit>
#include <cmath>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "tests/engine/volume/formats/segy_bytes.h"

namespace geosis {
namespace {

/// A survey of 2 x 2 traces whose first two samples are as stored.
template <class T>
SegyBytes two_by_two(int format_code, T first, T second, bool big_endian) {
  SegyBytes file(format_code, 2, sizeof(T), big_endian);
  for (int t = 0; t < 4; ++t) file.trace().word(189, t / 2).word(193, t % 2).sample(0, first).sample(1, second);
  return file;
}

template <class T>
void expect_samples(int format_code, T first, T second, float expected_first, float expected_second) {
  for (const bool big_endian : {true, false}) {
    SCOPED_TRACE(testing::Message() << "format " << format_code << (big_endian ? " big" : " little"));
    const auto volume = import_bytes(two_by_two(format_code, first, second, big_endian).bytes());
    ASSERT_TRUE(volume) << volume.error().message;
    EXPECT_EQ(sample_at(*volume, 1, 0, 0), expected_first);
    EXPECT_EQ(sample_at(*volume, 1, 1, 1), expected_second);
  }
}

TEST(ReadSegy, ReadsEverySampleFormat) {
  expect_samples<std::uint32_t>(1, 0x42640000, 0xc276a000, 100, -118.625f);
  expect_samples<std::int32_t>(2, -70000, 16777217, -70000, 16777216);
  expect_samples<std::int16_t>(3, -32768, 77, -32768, 77);
  expect_samples<std::uint32_t>(5, std::bit_cast<std::uint32_t>(1.5f), std::bit_cast<std::uint32_t>(-2e-40f), 1.5f,
                                -2e-40f);
  expect_samples<std::uint64_t>(6, std::bit_cast<std::uint64_t>(0.1), std::bit_cast<std::uint64_t>(-3.0), 0.1f, -3);
  expect_samples<std::int8_t>(8, -128, 127, -128, 127);
  expect_samples<std::int64_t>(9, -5000000000, 3, -5e9f, 3);
  expect_samples<std::uint32_t>(10, 4000000000u, 3u, 4e9f, 3);
  expect_samples<std::uint16_t>(11, 65535, 0, 65535, 0);
  expect_samples<std::uint64_t>(12, 1ull << 63, 3, 0x1p63f, 3);
  expect_samples<std::uint8_t>(16, 255, 1, 255, 1);
}

TEST(ReadSegy, RefusesFormatsItCannotRead) {
  auto bytes = two_by_two<std::int16_t>(3, 0, 0, true).bytes();
  bytes[3225] = std::byte{4};
  EXPECT_EQ(import_bytes(bytes).error().code, ErrorCode::unsupported);
  EXPECT_TRUE(import_bytes(bytes, {.sample_format = 3}));
  bytes[3225] = std::byte{0};
  EXPECT_EQ(import_bytes(bytes, {.format = FileFormat::segy}).error().code, ErrorCode::malformed_input);
  EXPECT_EQ(import_bytes(bytes, {.sample_format = 77}).error().code, ErrorCode::invalid_argument);
}

TEST(ReadSegy, TakesNullInfiniteAndNanSamplesAsMissing) {
  const auto null = std::bit_cast<std::uint32_t>(-999.25f);
  const auto infinite = std::bit_cast<std::uint32_t>(std::numeric_limits<float>::infinity());
  auto file = two_by_two<std::uint32_t>(5, null, 0x3f800000, true);
  file.sample(0, infinite);
  const auto volume = import_bytes(file.bytes(), {.null_value = -999.25});
  ASSERT_TRUE(volume) << volume.error().message;
  EXPECT_EQ(volume->description.missing_samples, 4);
  EXPECT_EQ(volume->description.missing_traces, 0);
  EXPECT_EQ(volume->description.value_range.min, 1);
  EXPECT_TRUE(std::isnan(sample_at(*volume, 0, 0, 0)));
  const auto& warnings = volume->description.warnings;
  EXPECT_TRUE(
      std::any_of(warnings.begin(), warnings.end(), [](const Warning& w) { return w.code == "infinite_samples"; }));
}

TEST(ReadSegy, FindsNullsThatIbmFloatsHoldExactlyOrTruncated) {
  const auto missing = [](std::uint32_t stored, double null) {
    const auto volume =
        import_bytes(two_by_two<std::uint32_t>(1, stored, 0x41100000, true).bytes(), {.null_value = null});
    EXPECT_TRUE(volume) << volume.error().message;
    return volume->description.missing_samples;
  };
  EXPECT_EQ(missing(0xc33e7400, -999.25), 4);
  EXPECT_EQ(missing(0x40199999, 0.1), 4);  // 0.1 with the digits that do not fit cut off
  EXPECT_EQ(missing(0x40199900, 0.1), 0);
}

TEST(ReadSegy, TakesEmptyAndDeadTracesAsMissing) {
  auto file = small_survey(3, 3);
  file.word<std::int16_t>(29, 2);  // the last trace is dead
  file.trace().word(189, 16).word(193, 305);
  const auto kept = import_bytes(file.bytes());
  ASSERT_TRUE(kept) << kept.error().message;
  EXPECT_EQ(kept->description.missing_traces, 3);  // dead, and two absent beside the new one
  const auto missing = import_bytes(file.bytes(), {.zero_traces = ZeroTraces::missing});
  ASSERT_TRUE(missing) << missing.error().message;
  EXPECT_EQ(missing->description.missing_traces, 4);
  EXPECT_EQ(missing->description.missing_samples, 12);
}

TEST(SampleAxis, ComesFromDelayAndInterval) {
  auto file = small_survey(3, 3);
  for (std::size_t trace = 3600; trace < file.bytes().size(); trace += 246) {
    file.bytes()[trace + 108] = std::byte{0x03};  // delay 0x03e7 = 999
    file.bytes()[trace + 109] = std::byte{0xe7};
  }
  file.set<std::int16_t>(3217, 2500);
  const auto volume = import_bytes(file.bytes());
  ASSERT_TRUE(volume) << volume.error().message;
  EXPECT_EQ(volume->description.sample_axis.first, 999);
  EXPECT_EQ(volume->description.sample_axis.step, 2.5);
  EXPECT_EQ(volume->description.sample_unit, "ms");
  EXPECT_EQ(volume->description.geometry.map({0, 0, 2}).z, 1004);
}

TEST(SampleAxis, FallsBackToTheTraceHeadersWithAWarning) {
  auto file = small_survey(3, 3);
  file.set<std::int16_t>(3217, -2);
  file.bytes()[3600 + 116] = std::byte{0x07};  // 0x07d0 = 2000 us
  file.bytes()[3600 + 117] = std::byte{0xd0};
  const auto volume = import_bytes(file.bytes());
  ASSERT_TRUE(volume) << volume.error().message;
  EXPECT_EQ(volume->description.sample_axis.step, 2);
  EXPECT_EQ(volume->description.warnings.front().code, "sample_interval");
}

TEST(SampleCount, IsTheTraceHeadersWhenOnlyItFitsTheFile) {
  auto file = small_survey(3, 3);
  file.set<std::uint16_t>(3221, 1000);
  EXPECT_NE(import_bytes(file.bytes()).error().message.find("cut short"), std::string::npos);
  file.bytes()[3600 + 115] = std::byte{3};
  const auto volume = import_bytes(file.bytes());
  ASSERT_TRUE(volume) << volume.error().message;
  EXPECT_EQ(volume->description.shape.samples, 3);
  EXPECT_EQ(volume->description.warnings.front().code, "sample_count");
}

TEST(Revision2, ReadsItsWiderWords) {
  SegyBytes file(5, 0, 4);
  file.set<std::uint16_t>(3501, 0x200).set<std::uint32_t>(3269, 70000).set(3273, std::bit_cast<std::uint64_t>(125.5));
  file.set<std::int32_t>(3297, 0x01020304);
  for (int t = 0; t < 4; ++t) {
    file.trace().word(189, t / 2).word(193, t % 2);
    file.bytes().resize(file.bytes().size() + 70000 * 4);
  }
  const auto volume = import_bytes(file.bytes());
  ASSERT_TRUE(volume) << volume.error().message;
  EXPECT_EQ(volume->description.shape, (GridShape{2, 2, 70000}));
  EXPECT_EQ(volume->description.sample_axis.step, 0.1255);
}

TEST(ExtendedText, IsCountedUpToItsEndMark) {
  auto file = small_survey(3, 3);
  file.set<std::int16_t>(3505, -1);
  EXPECT_NE(import_bytes(file.bytes()).error().message.find("EndText"), std::string::npos);
  std::string blocks(2 * 3200, ' ');
  blocks.replace(3200, 16, "((SEG: EndText))");
  const auto* first = reinterpret_cast<const std::byte*>(blocks.data());
  file.bytes().insert(file.bytes().begin() + 3600, first, first + blocks.size());
  const auto volume = import_bytes(file.bytes());
  ASSERT_TRUE(volume) << volume.error().message;
  EXPECT_EQ(volume->description.shape, (GridShape{3, 3, 3}));
}

TEST(ExtendedText, IsNotBelievedWhenTheFileDisagrees) {
  auto file = small_survey(3, 3);
  file.set<std::int16_t>(3505, 2);
  const auto volume = import_bytes(file.bytes());
  ASSERT_TRUE(volume) << volume.error().message;
  EXPECT_EQ(volume->description.warnings.front().code, "extended_text_count");
}

}  // namespace
}  // namespace geosis
