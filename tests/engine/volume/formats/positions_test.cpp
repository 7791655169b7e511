#include "engine/volume/formats/positions.h"

#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "engine/volume/brick_file.h"

namespace geosis {
namespace {

constexpr GridShape kShape = {5, 4, 6};

Vec3d place(int i, int j, int k) {
  return {5e5 + 25.0 * i, 6e6 + 12.5 * j, 1000 + 4.0 * k + i};
}

template <class Function>
void for_each(const Function& function) {
  for (int i = 0; i < kShape.inlines; ++i)
    for (int j = 0; j < kShape.crosslines; ++j)
      for (int k = 0; k < kShape.samples; ++k) function(i, j, k);
}

std::vector<double> node_numbers() {
  std::vector<double> numbers;
  for_each([&](int i, int j, int k) {
    const Vec3d p = place(i, j, k);
    numbers.insert(numbers.end(), {p.x, p.y, p.z});
  });
  return numbers;
}

/// Pillars that lean, and the depths on them.
std::vector<double> pillar_numbers() {
  std::vector<double> numbers;
  for (int i = 0; i < kShape.inlines; ++i)
    for (int j = 0; j < kShape.crosslines; ++j)
      numbers.insert(numbers.end(), {5e5 + 25.0 * i, 6e6 + 12.5 * j, 0, 5e5 + 25.0 * i + 10, 6e6 + 12.5 * j, 2000});
  for_each([&](int i, int j, int k) { numbers.push_back(place(i, j, k).z); });
  return numbers;
}

std::vector<std::byte> bytes_of(const std::vector<double>& numbers, const PositionFormat& format) {
  std::vector<std::byte> bytes;
  for (const double number : numbers) {
    const auto append = [&](auto value) {
      std::byte raw[sizeof value];
      std::memcpy(raw, &value, sizeof value);
      if (format.big_endian) std::reverse(std::begin(raw), std::end(raw));
      bytes.insert(bytes.end(), std::begin(raw), std::end(raw));
    };
    if (format.is_double)
      append(number);
    else
      append(static_cast<float>(number));
  }
  return bytes;
}

Result<NodeGrid> import(const std::vector<std::byte>& bytes, const PositionFormat& format) {
  NoProgress progress;
  return import_positions(*memory_source(bytes), kShape, format, std::nullopt, 1, progress);
}

TEST(ImportPositions, ReadsNodesOfEitherTypeAndByteOrder) {
  for (const bool is_double : {false, true}) {
    for (const bool big_endian : {false, true}) {
      const PositionFormat format{.is_double = is_double, .big_endian = big_endian};
      const auto bytes = bytes_of(node_numbers(), format);
      EXPECT_EQ(bytes.size(), position_bytes(kShape, format));
      const auto grid = import(bytes, format);
      ASSERT_TRUE(grid) << grid.error().message;
      for_each([&](int i, int j, int k) {
        const Vec3d at = grid->geometry.map({1.0 * i, 1.0 * j, 1.0 * k});
        EXPECT_LT(norm(at - place(i, j, k)), is_double ? 1e-5 : 0.3);
      });
    }
  }
}

TEST(ImportPositions, ReadsPillars) {
  const PositionFormat format{.kind = PositionFormat::Kind::pillars, .is_double = true};
  const auto bytes = bytes_of(pillar_numbers(), format);
  EXPECT_EQ(bytes.size(), position_bytes(kShape, format));
  const auto grid = import(bytes, format);
  ASSERT_TRUE(grid) << grid.error().message;
  for_each([&](int i, int j, int k) {
    const double z = place(i, j, k).z;
    const Vec3d expected = {5e5 + 25.0 * i + z / 200, 6e6 + 12.5 * j, z};
    EXPECT_LT(norm(grid->geometry.map({1.0 * i, 1.0 * j, 1.0 * k}) - expected), 1e-4);
  });
}

TEST(ImportPositions, IsTheSameGridHoweverItComes) {
  std::vector<double> nodes;
  std::vector<double> pillars;
  for (int i = 0; i < kShape.inlines; ++i)
    for (int j = 0; j < kShape.crosslines; ++j)
      pillars.insert(pillars.end(), {25.0 * i, 12.5 * j, 0, 25.0 * i, 12.5 * j, 8});
  for_each([&](int i, int j, int k) {
    nodes.insert(nodes.end(), {25.0 * i, 12.5 * j, 4.0 * k});
    pillars.push_back(4.0 * k);
  });
  const PositionFormat doubles{.is_double = true};
  const auto first = import(bytes_of(nodes, doubles), doubles);
  const PositionFormat floats{.big_endian = true};
  const auto second = import(bytes_of(nodes, floats), floats);
  const PositionFormat columns{.kind = PositionFormat::Kind::pillars};
  const auto third = import(bytes_of(pillars, columns), columns);
  const AffineGeometry survey({0, 0, 0}, {25, 0, 0}, {0, 12.5, 0}, {0, 0, 4});
  NoProgress progress;
  const auto fourth = place_nodes({.volumes = {}, .otherwise = survey}, kShape, std::nullopt, 1, progress);
  ASSERT_TRUE(first && second && third && fourth);
  EXPECT_EQ(second->summary.digest, first->summary.digest);
  EXPECT_EQ(third->summary.digest, first->summary.digest);
  EXPECT_EQ(fourth->summary.digest, first->summary.digest);
}

TEST(ImportPositions, SaysWhatFilesOfThatSizeMayBe) {
  const PositionFormat doubles{.is_double = true};
  const PositionFormat columns{.kind = PositionFormat::Kind::pillars, .is_double = true};
  EXPECT_EQ(import(bytes_of(node_numbers(), doubles), {}).error().message,
            "node positions: 2880 bytes; expected 1440 for the 5 x 4 x 6 nodes of the volume, as nodes of float32; as "
            "nodes of float64 they would fit");
  EXPECT_EQ(import(bytes_of(pillar_numbers(), columns), doubles).error().message,
            "node positions: 1920 bytes; expected 2880 for the 5 x 4 x 6 nodes of the volume, as nodes of float64; as "
            "pillars of float64 they would fit");
}

TEST(ImportPositions, RefusesWhatMakesNoGrid) {
  const PositionFormat format{.is_double = true};
  auto bytes = bytes_of(node_numbers(), format);
  bytes.pop_back();
  EXPECT_EQ(import(bytes, format).error().message,
            "node positions: 2879 bytes; expected 2880 for the 5 x 4 x 6 nodes of the volume, as nodes of float64");
  auto numbers = node_numbers();
  numbers[3 * 31 + 2] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(import(bytes_of(numbers, format), format).error().message,
            "node positions: node [1,1,1] is (500025, 6000012.5, nan): not finite");
  const PositionFormat columns{.kind = PositionFormat::Kind::pillars, .is_double = true};
  auto pillars = pillar_numbers();
  pillars[6 * 5 + 5] = 0;
  EXPECT_EQ(import(bytes_of(pillars, columns), columns).error().message,
            "node positions: the pillar of trace [1,1] has both ends at one depth");
  pillars[6 * 5 + 5] = std::numeric_limits<double>::infinity();
  EXPECT_NE(import(bytes_of(pillars, columns), columns).error().message.find("not finite"), std::string::npos);
}

std::unique_ptr<BrickedVolume> depths(float missing_at = -1) {
  std::vector<float> samples;
  for_each([&](int i, int j, int k) {
    const auto depth = static_cast<float>(1500 + 5 * k * k + 3 * j + i);
    samples.push_back(depth == missing_at ? std::numeric_limits<float>::quiet_NaN() : depth);
  });
  return make_bricked_volume(kShape, samples);
}

TEST(PlaceNodes, TakesCoordinatesFromVolumesAndTheRestFromTheSurvey) {
  const AffineGeometry survey({1000, 2000, 0}, {0, 25, 0}, {12.5, 0, 0}, {0, 0, 4});
  const auto z = depths();
  NoProgress progress;
  const CoordinateVolumes given{.volumes = {nullptr, nullptr, z.get()}, .otherwise = survey, .times = true};
  const auto grid = place_nodes(given, kShape, std::nullopt, 1, progress);
  ASSERT_TRUE(grid) << grid.error().message;
  EXPECT_EQ(grid->geometry.map({2, 3, 4}), (Vec3d{1037.5, 2050, 1500 + 80 + 9 + 2}));
  EXPECT_TRUE(grid->summary.report.mirrored);
  EXPECT_FALSE(grid->summary.times);
  const CoordinateVolumes sideways{
      .volumes = {z.get(), nullptr, nullptr}, .otherwise = AffineGeometry(), .times = true};
  const auto other = place_nodes(sideways, kShape, std::nullopt, 1, progress);
  EXPECT_TRUE(!other || other->summary.times);
}

TEST(PlaceNodes, SaysWhichSampleIsMissing) {
  const auto z = depths(1500 + 5 * 9 + 3 * 2 + 1);
  NoProgress progress;
  const CoordinateVolumes given{.volumes = {nullptr, nullptr, z.get()}, .otherwise = AffineGeometry()};
  const auto refused = place_nodes(given, kShape, std::nullopt, 1, progress);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::malformed_input);
  EXPECT_EQ(refused.error().message, "z: node [1,2,3] is missing in the volume that it is taken from");
}

}  // namespace
}  // namespace geosis
