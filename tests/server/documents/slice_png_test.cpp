#include "server/documents/slice_png.h"

#include <array>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <png.h>

namespace geosis::server {
namespace {

constexpr float kMissing = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

using Pixel = std::array<int, 4>;
constexpr Pixel kTransparent = {0, 0, 0, 0};

struct Image {
  std::uint32_t rows = 0, columns = 0;
  std::vector<Pixel> pixels;
};

Image decode(const std::vector<std::byte>& bytes) {
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  EXPECT_TRUE(png_image_begin_read_from_memory(&header, bytes.data(), bytes.size())) << header.message;
  EXPECT_EQ(header.format, std::uint32_t{PNG_FORMAT_RGBA});
  std::vector<png_byte> raw(PNG_IMAGE_SIZE(header));
  EXPECT_TRUE(png_image_finish_read(&header, nullptr, raw.data(), 0, nullptr)) << header.message;
  Image image{header.height, header.width, {}};
  for (std::size_t p = 0; p < raw.size(); p += 4) image.pixels.push_back({raw[p], raw[p + 1], raw[p + 2], raw[p + 3]});
  return image;
}

std::vector<Pixel> colors(const std::vector<float>& samples, float low, float high, Colormap colormap) {
  const Slice slice{1, static_cast<std::int32_t>(samples.size()), samples};
  return decode(slice_png(slice, low, high, colormap).value()).pixels;
}

Pixel gray(int level) {
  return {level, level, level, 255};
}

TEST(SlicePng, DrawsEverySampleAsOnePixel) {
  std::mt19937 random(3);
  Slice slice{131, 67, {}};
  std::vector<Pixel> expected;
  for (int p = 0; p < slice.rows * slice.columns; ++p) {
    const int level = static_cast<int>(random() % 257);  // 256 stands for a missing sample
    slice.samples.push_back(level == 256 ? kMissing : static_cast<float>(level));
    expected.push_back(level == 256 ? kTransparent : gray(level));
  }
  const Image image = decode(slice_png(slice, 0, 255, Colormap::gray).value());
  EXPECT_EQ(image.rows, 131u);
  EXPECT_EQ(image.columns, 67u);
  EXPECT_EQ(image.pixels, expected);
}

TEST(SlicePng, SamplesBeyondTheRangeGetTheOuterColours) {
  EXPECT_EQ(colors({-kInfinity, -3, -1, 1, 3, kInfinity}, -1, 1, Colormap::gray),
            (std::vector<Pixel>{gray(0), gray(0), gray(0), gray(255), gray(255), gray(255)}));
}

TEST(SlicePng, RangeOfOneValueSplitsBelowEqualAndAbove) {
  EXPECT_EQ(colors({4, 5, 6, kMissing}, 5, 5, Colormap::gray),
            (std::vector<Pixel>{gray(0), gray(128), gray(255), kTransparent}));
}

TEST(SlicePng, WidestRangeOfFloatsDoesNotOverflow) {
  constexpr float most = std::numeric_limits<float>::max();
  EXPECT_EQ(colors({-most, 0, most}, -most, most, Colormap::gray), (std::vector<Pixel>{gray(0), gray(128), gray(255)}));
}

TEST(SlicePng, SeismicGoesFromBlueOverWhiteToRed) {
  const auto shown = colors({-1, 0, 1}, -1, 1, Colormap::seismic);
  EXPECT_GT(shown[0][2], shown[0][0] + 64);
  for (int channel = 0; channel < 3; ++channel) EXPECT_GE(shown[1][static_cast<std::size_t>(channel)], 250);
  EXPECT_GT(shown[2][0], shown[2][2] + 64);
}

TEST(SlicePng, ViridisGetsLighterAllTheWay) {
  std::vector<float> ramp(256);
  for (std::size_t c = 0; c < ramp.size(); ++c) ramp[c] = static_cast<float>(c);
  const auto shown = colors(ramp, 0, 255, Colormap::viridis);
  EXPECT_EQ(shown.front(), (Pixel{68, 1, 84, 255}));
  EXPECT_EQ(shown.back(), (Pixel{253, 231, 37, 255}));
  const auto luma = [](const Pixel& p) { return 0.2126 * p[0] + 0.7152 * p[1] + 0.0722 * p[2]; };
  for (std::size_t c = 2; c < shown.size(); ++c) EXPECT_GT(luma(shown[c]), luma(shown[c - 2])) << c;
}

TEST(SlicePng, SameSliceGivesTheSameBytes) {
  const Slice slice{2, 3, {1, 2, kMissing, 4, 5, 6}};
  EXPECT_EQ(slice_png(slice, 0, 6, Colormap::viridis).value(), slice_png(slice, 0, 6, Colormap::viridis).value());
}

ErrorCode code_of(const Slice& slice, float low, float high) {
  const auto image = slice_png(slice, low, high, Colormap::gray);
  EXPECT_FALSE(image);
  return image ? ErrorCode::internal : image.error().code;
}

TEST(SlicePng, RejectsRangesThatAreNotRanges) {
  const Slice slice{1, 1, {0}};
  EXPECT_EQ(code_of(slice, 1, 0), ErrorCode::invalid_argument);
  EXPECT_EQ(code_of(slice, kMissing, 0), ErrorCode::invalid_argument);
  EXPECT_EQ(code_of(slice, 0, kInfinity), ErrorCode::invalid_argument);
}

TEST(SlicePng, RejectsSlicesThatAreNotRowsTimesColumns) {
  EXPECT_EQ(code_of({2, 2, {1, 2, 3}}, 0, 1), ErrorCode::invalid_argument);
  EXPECT_EQ(code_of({0, 2, {}}, 0, 1), ErrorCode::invalid_argument);
  EXPECT_EQ(code_of({-1, -1, {1}}, 0, 1), ErrorCode::invalid_argument);
}

TEST(SlicePng, RefusesMorePixelsThanTheLimit) {
  EXPECT_EQ(code_of({8193, 8192, {}}, 0, 1), ErrorCode::limit_exceeded);
  constexpr std::int32_t most = std::numeric_limits<std::int32_t>::max();
  EXPECT_EQ(code_of({most, most, {}}, 0, 1), ErrorCode::limit_exceeded);
}

TEST(SlicePng, ReportsWhatLibpngRefuses) {
  // libpng draws at most a million columns.
  const auto image = slice_png({1, 1'000'001, std::vector<float>(1'000'001)}, 0, 1, Colormap::gray);
  ASSERT_FALSE(image);
  EXPECT_EQ(image.error().code, ErrorCode::internal);
  EXPECT_EQ(image.error().message.find("PNG image: "), 0u);
  EXPECT_GT(image.error().message.size(), std::string("PNG image: ").size());
}

TEST(ParseColormap, KnowsItsNames) {
  EXPECT_EQ(parse_colormap("gray").value(), Colormap::gray);
  EXPECT_EQ(parse_colormap("seismic").value(), Colormap::seismic);
  EXPECT_EQ(parse_colormap("viridis").value(), Colormap::viridis);
  EXPECT_EQ(parse_colormap("jet").error().code, ErrorCode::invalid_argument);
  EXPECT_EQ(parse_colormap("jet").error().message, "colormap \"jet\"; expected gray, seismic or viridis");
}

}  // namespace
}  // namespace geosis::server
