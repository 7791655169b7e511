#include "engine/volume/formats/raw.h"

#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "tests/engine/volume/formats/segy_bytes.h"

namespace geosis {
namespace {

template <class T>
std::vector<std::byte> stored(const std::vector<T>& values, bool big_endian) {
  std::vector<std::byte> bytes;
  for (const T value : values) {
    std::byte word[sizeof value];
    std::memcpy(word, &value, sizeof value);
    if (big_endian) std::reverse(std::begin(word), std::end(word));
    bytes.insert(bytes.end(), std::begin(word), std::end(word));
  }
  return bytes;
}

template <class T>
void expect_reads(SampleType dtype) {
  const std::vector<T> values = {T(1), T(2), T(3), T(4), T(5), T(6), T(7), std::numeric_limits<T>::max()};
  for (const bool big_endian : {false, true}) {
    const auto volume = import_bytes(
        stored(values, big_endian),
        {.byte_order = big_endian ? ByteOrder::big : ByteOrder::automatic, .dims = GridShape{2, 2, 2}, .dtype = dtype});
    ASSERT_TRUE(volume) << volume.error().message;
    EXPECT_EQ(sample_at(*volume, 1, 0, 1), 6);
    if (dtype == SampleType::float64)
      EXPECT_TRUE(std::isnan(sample_at(*volume, 1, 1, 1)));
    else
      EXPECT_EQ(sample_at(*volume, 1, 1, 1), static_cast<float>(values.back()));
  }
}

TEST(ReadRaw, ReadsEveryTypeInBothByteOrders) {
  expect_reads<float>(SampleType::float32);
  expect_reads<double>(SampleType::float64);
  expect_reads<std::int8_t>(SampleType::int8);
  expect_reads<std::uint8_t>(SampleType::uint8);
  expect_reads<std::int16_t>(SampleType::int16);
  expect_reads<std::uint16_t>(SampleType::uint16);
  expect_reads<std::int32_t>(SampleType::int32);
  expect_reads<std::uint32_t>(SampleType::uint32);
}

TEST(ReadRaw, TurnsFilesWhoseInlineIndexIsFastest) {
  constexpr GridShape shape{70, 3, 130};
  std::vector<float> by_inline, by_sample;
  const auto value = [](int i, int j, int k) { return static_cast<float>(i * 1000 + j * 200 + k); };
  for (int k = 0; k < shape.samples; ++k)
    for (int j = 0; j < shape.crosslines; ++j)
      for (int i = 0; i < shape.inlines; ++i) by_inline.push_back(value(i, j, k));
  for (int i = 0; i < shape.inlines; ++i)
    for (int j = 0; j < shape.crosslines; ++j)
      for (int k = 0; k < shape.samples; ++k) by_sample.push_back(value(i, j, k));
  const auto turned = import_bytes(stored(by_inline, false), {.dims = shape, .order = RawOrder::inline_fastest});
  const auto straight = import_bytes(stored(by_sample, false), {.dims = shape});
  ASSERT_TRUE(turned && straight);
  for (std::size_t brick = 0; brick < straight->samples->brick_count(); ++brick) {
    const auto a = turned->samples->brick(brick), b = straight->samples->brick(brick);
    ASSERT_TRUE(a && b);
    const auto bytes = static_cast<std::size_t>(b->extent.count()) * sizeof(float);
    EXPECT_EQ(std::memcmp(a->samples, b->samples, bytes), 0) << "brick " << brick;
  }
}

TEST(ReadRaw, CountsNullsAndWholeMissingTraces) {
  const std::vector<std::int16_t> values = {-1, -1, 3, -1, 5, 6, 7, 8};
  for (const RawOrder order : {RawOrder::sample_fastest, RawOrder::inline_fastest}) {
    const auto volume =
        import_bytes(stored(values, false),
                     {.null_value = -1, .dims = GridShape{2, 2, 2}, .dtype = SampleType::int16, .order = order});
    ASSERT_TRUE(volume) << volume.error().message;
    EXPECT_EQ(volume->description.missing_samples, 3);
    EXPECT_EQ(volume->description.missing_traces, order == RawOrder::sample_fastest ? 1 : 0);
    EXPECT_EQ(volume->description.value_range.min, 3);
  }
}

// Bricks share layers of samples: what lies on one is counted once.
TEST(ReadRaw, CountsMissingSamplesOfSharedLayersOnce) {
  constexpr GridShape shape{66, 130, 70};
  const auto bad = [](int i, int j, int k) { return i == 63 || j == 63 || j == 126 || k == 63 || (i == 5 && j == 7); };
  const auto stored_in = [&](RawOrder order) {
    std::vector<float> values(static_cast<std::size_t>(shape.count()), 1);
    for (int i = 0; i < shape.inlines; ++i)
      for (int j = 0; j < shape.crosslines; ++j)
        for (int k = 0; k < shape.samples; ++k) {
          const bool by_sample = order == RawOrder::sample_fastest;
          const int at = by_sample ? (i * shape.crosslines + j) * shape.samples + k
                                   : (k * shape.crosslines + j) * shape.inlines + i;
          if (bad(i, j, k)) values[static_cast<std::size_t>(at)] = k == 63 ? INFINITY : NAN;
        }
    return stored(values, false);
  };
  constexpr std::int64_t kBadTraces = 130 + 65 * 2 + 1, kInfinite = 66 * 130;
  for (const RawOrder order : {RawOrder::sample_fastest, RawOrder::inline_fastest}) {
    const auto volume = import_bytes(stored_in(order), {.dims = shape, .order = order});
    ASSERT_TRUE(volume) << volume.error().message;
    EXPECT_EQ(volume->description.missing_traces, kBadTraces);
    EXPECT_EQ(volume->description.missing_samples, kBadTraces * 70 + (66 * 130 - kBadTraces));
    ASSERT_EQ(volume->description.warnings.size(), 1u);
    EXPECT_NE(volume->description.warnings[0].detail.find(std::to_string(kInfinite)), std::string::npos);
  }
}

TEST(ReadRaw, PlacesTheVolumeInTheWorld) {
  const auto volume = import_bytes(stored(std::vector<float>(8), false),
                                   {.dims = GridShape{2, 2, 2}, .origin = {10, 20, 30}, .spacing = {3.2, -3.2, 1.5}});
  ASSERT_TRUE(volume) << volume.error().message;
  EXPECT_EQ(volume->description.geometry.map({1, 1, 1}), (Vec3d{13.2, 16.8, 31.5}));
  EXPECT_TRUE(volume->description.geometry.mirrored());
  EXPECT_EQ(volume->description.format, "raw");
}

TEST(ReadRaw, NamesExpectedAndActualBytes) {
  const std::vector<std::byte> bytes(100);
  const auto wrong = import_bytes(bytes, {.dims = GridShape{2, 3, 4}});
  ASSERT_FALSE(wrong);
  EXPECT_EQ(wrong.error().code, ErrorCode::malformed_input);
  EXPECT_EQ(wrong.error().message, "raw: 100 bytes; expected 96 for 2 x 3 x 4 samples of 4 bytes");
}

TEST(ReadRaw, RefusesImpossibleOptions) {
  const std::vector<std::byte> bytes(32);
  const auto code = [&](const ImportOptions& options) { return import_bytes(bytes, options).error().code; };
  EXPECT_EQ(code({.format = FileFormat::raw}), ErrorCode::invalid_argument);
  EXPECT_EQ(code({.dims = GridShape{1, 2, 4}}), ErrorCode::invalid_argument);
  EXPECT_EQ(code({.dims = GridShape{-2, -2, 2}}), ErrorCode::invalid_argument);
  EXPECT_EQ(code({.dims = GridShape{2, 2, INT32_MAX}}), ErrorCode::limit_exceeded);
  EXPECT_EQ(code({.dims = GridShape{131071, 131071, 131071}, .dtype = SampleType::float64}),
            ErrorCode::malformed_input);
  EXPECT_EQ(code({.dims = GridShape{2, 2, 2}, .spacing = {1, 0, 1}}), ErrorCode::invalid_argument);
  EXPECT_EQ(code({.dims = GridShape{2, 2, 2}, .origin = {NAN, 0, 0}}), ErrorCode::invalid_argument);
}

}  // namespace
}  // namespace geosis
