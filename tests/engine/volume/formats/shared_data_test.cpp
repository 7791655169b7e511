// Every file of the shared data folder opens with what its README states, or is refused for the stated reason.

#include "tests/support/shared_data.h"

#include <filesystem>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <zlib.h>

#include "engine/volume/formats/import.h"

namespace geosis {
namespace {

/// A file's bytes, unzipped when they are gzip.
std::vector<std::byte> read_bytes(const std::filesystem::path& path) {
  std::vector<std::byte> bytes;
  const gzFile file = gzopen(path.c_str(), "rb");
  if (!file) return bytes;
  std::byte piece[1 << 16];
  for (int got = 0; (got = gzread(file, piece, sizeof piece)) > 0;) bytes.insert(bytes.end(), piece, piece + got);
  gzclose(file);
  return bytes;
}

Result<ImportedVolume> import_bytes(std::span<const std::byte> bytes, const ImportOptions& options,
                                    std::vector<GridCandidate>* candidates = nullptr) {
  NoProgress unwatched;
  return import_volume(*memory_source(bytes), options, std::nullopt, unwatched, candidates);
}

struct Opens {
  std::string file;
  GridShape shape;
  ValueRange range;
  std::int64_t missing_traces = 0;
  Axis inline_axis, crossline_axis, sample_axis;
};
void PrintTo(const Opens& expected, std::ostream* out) {
  *out << expected.file;
}

class SharedSurvey : public testing::TestWithParam<Opens> {};

TEST_P(SharedSurvey, OpensAsItsReadmeStates) {
  const Opens& expected = GetParam();
  if (!exists(shared_file(expected.file))) GTEST_SKIP() << shared_file(expected.file) << " is absent";
  NoProgress unwatched;
  const auto source = open_file(shared_file(expected.file));
  ASSERT_TRUE(source) << source.error().message;
  const auto volume = import_volume(**source, {}, std::nullopt, unwatched);
  ASSERT_TRUE(volume) << volume.error().message;
  const VolumeDescription& d = volume->description;
  EXPECT_EQ(d.shape, expected.shape);
  EXPECT_EQ(volume->samples->shape(), expected.shape);
  EXPECT_NEAR(d.value_range.min, expected.range.min, 5e-4);
  EXPECT_NEAR(d.value_range.max, expected.range.max, 5e-4);
  EXPECT_EQ(d.missing_traces, expected.missing_traces);
  EXPECT_EQ(d.missing_samples, expected.missing_traces * expected.shape.samples);
  EXPECT_EQ(d.inline_axis.first, expected.inline_axis.first);
  EXPECT_EQ(d.inline_axis.step, expected.inline_axis.step);
  EXPECT_EQ(d.crossline_axis.first, expected.crossline_axis.first);
  EXPECT_EQ(d.crossline_axis.step, expected.crossline_axis.step);
  EXPECT_EQ(d.sample_axis.first, expected.sample_axis.first);
  EXPECT_EQ(d.sample_axis.step, expected.sample_axis.step);
  EXPECT_EQ(d.digest.size(), 64u);
}

constexpr GridShape kF3{23, 18, 75};
Opens f3(const std::string& file, ValueRange range = {-10239, 10827}, std::int64_t missing_traces = 0) {
  return {file, kF3, range, missing_traces, {111, 1}, {875, 1}, {4, 4}};
}
Opens small(const std::string& file) {
  return {"segy-cases/segyio-" + file, {5, 5, 50}, {1.2f, 5.24049f}, 0, {1, 1}, {20, 1}, {0, 4}};
}

INSTANTIATE_TEST_SUITE_P(
    Seismic, SharedSurvey,
    testing::Values(
        Opens{"seismic/petrel_buildup_3d.sgy", {76, 181, 268}, {-0.976f, 1.420f}, 0, {1971, 2}, {2775, 1}, {999, 3}},
        f3("seismic/f3_crop_int16.sgy"), f3("seismic/f3_crop_missing_traces.sgy", {-10239, 10827}, 414 - 239),
        f3("segy-cases/segyio-f3-Format1msb.sgy"), f3("segy-cases/segyio-f3-Format1lsb.sgy"),
        f3("segy-cases/segyio-f3-Format2msb.sgy"), f3("segy-cases/segyio-f3-Format3msb.sgy"),
        f3("segy-cases/segyio-f3-Format3lsb.sgy"), f3("segy-cases/segyio-f3-Format5msb.sgy"),
        f3("segy-cases/segyio-f3-Format5lsb.sgy"), f3("segy-cases/segyio-f3-Format8msb.sgy", {-128, 127})));

INSTANTIATE_TEST_SUITE_P(
    Cases, SharedSurvey,
    testing::Values(
        small("small.sgy"), small("small-lsb.sgy"), small("acute-small.sgy"), small("straight-small.sgy"),
        small("text-embed-null.sgy"), small("rotated-small-rev2.sgy"),
        Opens{"segy-cases/segyio-tiny.sgy", {3, 2, 4}, {1.2f, 3.21003f}, 0, {1, 1}, {20, 1}, {0, 1}},
        Opens{
            "segy-cases/segyio-trace-header-extension1.sgy", {3, 2, 4}, {1.2f, 3.21003f}, 0, {1, 1}, {20, 1}, {0, 1}}));

struct Refused {
  std::string file;
  ErrorCode code;
  std::string reason;  ///< part of the message
};
void PrintTo(const Refused& expected, std::ostream* out) {
  *out << expected.file;
}

class SharedNonsense : public testing::TestWithParam<Refused> {};

TEST_P(SharedNonsense, IsRefusedByName) {
  const Refused& expected = GetParam();
  if (!exists(shared_file(expected.file))) GTEST_SKIP() << shared_file(expected.file) << " is absent";
  const auto volume = import_bytes(read_bytes(shared_file(expected.file)), {});
  ASSERT_FALSE(volume);
  EXPECT_EQ(volume.error().code, expected.code) << volume.error().message;
  EXPECT_NE(volume.error().message.find(expected.reason), std::string::npos) << volume.error().message;
}

INSTANTIATE_TEST_SUITE_P(
    Cases, SharedNonsense,
    testing::Values(Refused{"seismic/viking_small_2d.segy", ErrorCode::unsupported, "shot gathers"},
                    Refused{"segy-cases/segyio-1xN.sgy", ErrorCode::unsupported, "prestack 2D line"},
                    Refused{"segy-cases/segyio-small-ps.sgy", ErrorCode::unsupported, "prestack"},
                    Refused{"segy-cases/segyio-small-ps-dec-il-xl-off.sgy", ErrorCode::unsupported, "prestack"},
                    Refused{"segy-cases/segyio-shot-gather.sgy", ErrorCode::unsupported, "shot gathers"},
                    Refused{"segy-cases/segyio-broken.sgy", ErrorCode::malformed_input, "cut short"},
                    Refused{"segy-cases/segyio-text.sgy", ErrorCode::malformed_input, "no traces"},
                    Refused{"segy-cases/segyio-small.su", ErrorCode::malformed_input, "no SEG-Y file headers"},
                    Refused{"segy-cases/segyio-long.sgy", ErrorCode::malformed_input, "60000 samples"},
                    Refused{"segy-cases/segyio-delay-scalar.sgy", ErrorCode::unsupported, "a single trace"},
                    Refused{"segy-cases/segyio-interval-neg-bin-pos-trace.sgy", ErrorCode::unsupported, "1 sample"},
                    Refused{"segy-cases/segyio-multi-text.sgy", ErrorCode::unsupported, "1 sample"}));

TEST(SharedPrestack, OpensWhenTheDuplicatesAreNamed) {
  const auto path = shared_file("segy-cases/segyio-small-ps.sgy");
  if (!exists(path)) GTEST_SKIP() << path << " is absent";
  const auto bytes = read_bytes(path);
  const auto volume = import_bytes(bytes, {.duplicates = DuplicateTraces::first});
  ASSERT_TRUE(volume) << volume.error().message;
  EXPECT_EQ(volume->description.shape, (GridShape{4, 3, 10}));
  EXPECT_EQ(volume->description.missing_samples, 0);
}

TEST(SharedF3, LiesOnItsBinsInTheWorld) {
  const auto path = shared_file("seismic/f3_crop_int16.sgy");
  if (!exists(path)) GTEST_SKIP() << path << " is absent";
  const auto bytes = read_bytes(path);
  const auto volume = import_bytes(bytes, {});
  ASSERT_TRUE(volume) << volume.error().message;
  const VolumeDescription& d = volume->description;
  const Vec3d first = d.geometry.map({0, 0, 0}), opposite = d.geometry.map({22, 17, 74});
  EXPECT_NEAR(first.x, 620197.2, 0.2);
  EXPECT_NEAR(first.y, 6074232.9, 0.2);
  EXPECT_NEAR(opposite.x, 620606.8, 0.2);
  EXPECT_NEAR(opposite.y, 6074794.5, 0.2);
  EXPECT_EQ(opposite.z, 300);
  EXPECT_EQ(d.options.x_byte, 181);
  EXPECT_FALSE(d.text_header.empty());
}

struct RawFile {
  std::string file;
  GridShape shape;
  SampleType dtype;
  ByteOrder byte_order;
  ValueRange range;
};
void PrintTo(const RawFile& expected, std::ostream* out) {
  *out << expected.file;
}

class SharedRaw : public testing::TestWithParam<RawFile> {};

TEST_P(SharedRaw, OpensWithItsRangeAndSamples) {
  const RawFile& expected = GetParam();
  if (!exists(shared_file(expected.file))) GTEST_SKIP() << shared_file(expected.file) << " is absent";
  const auto bytes = read_bytes(shared_file(expected.file));
  const auto volume = import_bytes(bytes, {.byte_order = expected.byte_order,
                                           .dims = expected.shape,
                                           .dtype = expected.dtype,
                                           .order = RawOrder::inline_fastest});
  ASSERT_TRUE(volume) << volume.error().message;
  EXPECT_EQ(volume->description.value_range.min, expected.range.min);
  EXPECT_EQ(volume->description.value_range.max, expected.range.max);
  EXPECT_EQ(volume->description.missing_samples, 0);
  const auto wrong = import_bytes(std::span(bytes).first(bytes.size() - 1), volume->description.options);
  ASSERT_FALSE(wrong);
  EXPECT_EQ(wrong.error().code, ErrorCode::malformed_input);
}

INSTANTIATE_TEST_SUITE_P(
    Volumes, SharedRaw,
    testing::Values(
        RawFile{
            "volumes/bonsai_256x256x256_u8.raw.gz", {256, 256, 256}, SampleType::uint8, ByteOrder::automatic, {0, 255}},
        RawFile{"volumes/fuel_64x33x32_u8.raw", {64, 33, 32}, SampleType::uint8, ByteOrder::automatic, {0, 255}},
        RawFile{"volumes/headsq_64x64x93_i16le.raw", {64, 64, 93}, SampleType::int16, ByteOrder::little, {0, 3926}},
        RawFile{"volumes/tooth_103x94x161_u16be.raw", {103, 94, 161}, SampleType::uint16, ByteOrder::big, {0, 1300}},
        RawFile{
            "volumes/stent_128x128x256_i16le.raw.gz", {128, 128, 256}, SampleType::int16, ByteOrder::little, {0, 2000}},
        RawFile{"volumes/ketton_256x256x256_u8.raw.gz",
                {256, 256, 256},
                SampleType::uint8,
                ByteOrder::automatic,
                {0, 255}}));

}  // namespace
}  // namespace geosis
