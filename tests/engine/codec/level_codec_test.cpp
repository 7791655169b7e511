#include "engine/codec/level_codec.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "engine/codec/cut_parts.h"
#include "engine/codec/draco_part.h"
#include "tests/engine/codec/codec_checks.h"

namespace geosis {
namespace {

using test::bytes_of;
using test::expect_round_trip;

const EncodeOptions kWhole = {.position_bits = 13};
const EncodeOptions kTinyParts = {.position_bits = 13, .max_part_triangles = 50};

TEST(EncodeLevel, StopsBeforeTheNextPartWhenCancelled) {
  class Cancelled final : public Progress {
    void report(const char*, double) override {}
    bool cancelled() const override { return true; }
  };
  const IndexedMesh mesh = test::sphere({32, 32, 32}, 20, 30, 40);
  EXPECT_EQ(encode_level(mesh, {}, kTinyParts, Cancelled()).error().code, ErrorCode::cancelled);
  const auto encoded = encode_level(mesh, {}, kTinyParts);
  ASSERT_TRUE(encoded);
  std::vector<std::span<const std::byte>> parts;
  for (const EncodedPart& part : encoded->parts) parts.emplace_back(part.bytes);
  EXPECT_EQ(decode_level(parts, 1, Cancelled()).error().code, ErrorCode::cancelled);
}

TEST(EncodeLevel, SphereComesBackWhole) {
  expect_round_trip(test::sphere({32, 32, 32}, 20, 30, 40), kWhole);
}

TEST(EncodeLevel, SphereComesBackFromTinyParts) {
  expect_round_trip(test::sphere({32, 32, 32}, 20, 30, 40), kTinyParts);
}

TEST(EncodeLevel, TorusKeepsItsHandleAcrossParts) {
  expect_round_trip(test::torus({32, 32, 32}, 15, 6, 30, 20), kTinyParts);
}

TEST(EncodeLevel, OpenSheetKeepsItsBoundaryAcrossParts) {
  expect_round_trip(test::sheet(20, 5), kTinyParts);
}

TEST(EncodeLevel, ManyOpenComponentsComeBack) {
  IndexedMesh mesh = test::sheet(1, 0);
  for (int k = 1; k < 40; ++k) test::append(mesh, test::sheet(k % 5 + 1, static_cast<float>(k)));
  expect_round_trip(mesh, kTinyParts);
}

TEST(EncodeLevel, EveryTriangleMayBeItsOwnPart) {
  expect_round_trip(test::box({1, 2, 3}, {4, 5, 6}), {.position_bits = 13, .max_part_triangles = 1});
}

TEST(EncodeLevel, ComponentsOnTheSamePositionsStayApart) {
  IndexedMesh mesh = test::sphere({10, 10, 10}, 5, 6, 6);
  test::append(mesh, mesh);
  expect_round_trip(mesh, kTinyParts);
}

/// Parts cut from a shuffled order touch themselves in points almost everywhere: Draco splits those vertices, and the
/// seam ids must make them one again.
TEST(EncodeLevel, PinchedPartBordersAreJoinedAgain) {
  IndexedMesh mesh = test::torus({32, 32, 32}, 15, 6, 24, 16);
  std::mt19937 random(7);
  std::shuffle(mesh.triangles.begin(), mesh.triangles.end(), random);
  const PartPlan plan = plan_parts(mesh, kTinyParts.max_part_triangles);
  const auto part = decode_part(encode_part(cut_part(mesh, {}, plan, 0), kTinyParts)->bytes);
  ASSERT_GT(part->mesh.positions.size(), cut_part(mesh, {}, plan, 0).mesh.positions.size());
  expect_round_trip(mesh, kTinyParts);
}

TEST(EncodeLevel, RandomShapesComeBackAtEverySpeed) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  for (int speed = 0; speed <= 10; ++speed) {
    IndexedMesh mesh = test::random_shapes(random, 1 + speed % 5 * 3);
    if (speed % 2 == 0) std::shuffle(mesh.triangles.begin(), mesh.triangles.end(), random);
    const auto limit = static_cast<std::int32_t>(1 + random() % 200);
    SCOPED_TRACE("speed " + std::to_string(speed) + ", parts of " + std::to_string(limit));
    expect_round_trip(mesh, {.position_bits = 12, .max_part_triangles = limit, .speed = speed});
  }
}

TEST(EncodeLevel, FurthestLatticePositionComesBackAtEveryBitCount) {
  for (int bits = 8; bits <= kMaxPositionBits; ++bits) {
    const float end = static_cast<float>((1 << bits) - 1) * kLatticeStep;
    expect_round_trip(test::box({0, 0, kLatticeStep}, {end, end - kLatticeStep, end}), {.position_bits = bits});
  }
}

TEST(EncodeLevel, PartsAreEqualInSizeAndNeverTooLarge) {
  const auto encoded = encode_level(test::sheet(10, 0), {}, {.max_part_triangles = 60});  // 200 triangles
  ASSERT_TRUE(encoded);
  ASSERT_EQ(encoded->parts.size(), 4u);
  for (const EncodedPart& part : encoded->parts) EXPECT_EQ(part.triangles, 50);
}

TEST(EncodeLevel, AnyNumberOfThreadsMakesTheSameBytes) {
  const IndexedMesh mesh = test::sphere({32, 32, 32}, 20, 30, 40);
  EncodeOptions options = kTinyParts;
  const auto serial = encode_level(mesh, {}, options);
  options.threads = 4;
  const auto parallel = encode_level(mesh, {}, options);
  ASSERT_TRUE(serial);
  ASSERT_TRUE(parallel);
  ASSERT_EQ(serial->parts.size(), parallel->parts.size());
  for (std::size_t p = 0; p < serial->parts.size(); ++p) EXPECT_EQ(serial->parts[p].bytes, parallel->parts[p].bytes);
  EXPECT_EQ(decode_level(bytes_of(*serial), 1)->mesh.triangles, decode_level(bytes_of(*serial), 4)->mesh.triangles);
}

TEST(EncodeLevel, UnusedVerticesAreLeftOut) {
  IndexedMesh mesh = test::box({1, 2, 3}, {4, 5, 6});
  mesh.positions.push_back({7, 7, 7});
  const auto decoded = decode_level(bytes_of(*encode_level(mesh, {}, kWhole)));
  ASSERT_TRUE(decoded);
  EXPECT_EQ(decoded->mesh.positions.size(), 8u);
}

TEST(DecodeLevel, RefusesAMissingPart) {
  const auto encoded = encode_level(test::sphere({32, 32, 32}, 20, 10, 10), {}, kTinyParts);
  auto parts = bytes_of(*encoded);
  parts.pop_back();
  const auto decoded = decode_level(parts);
  ASSERT_FALSE(decoded);
  EXPECT_EQ(decoded.error().code, ErrorCode::malformed_input);
  EXPECT_NE(decoded.error().message.find("a part is missing"), std::string::npos) << decoded.error().message;
}

TEST(DecodeLevel, RefusesALevelWithoutParts) {
  ASSERT_FALSE(decode_level({}));
  EXPECT_EQ(decode_level({}).error().code, ErrorCode::malformed_input);
}

TEST(DecodeLevel, NamesThePartThatIsDamaged) {
  auto encoded = encode_level(test::sphere({32, 32, 32}, 20, 10, 10), {}, kTinyParts);
  encoded->parts[1].bytes.resize(20);
  const auto decoded = decode_level(bytes_of(*encoded));
  ASSERT_FALSE(decoded);
  EXPECT_EQ(decoded.error().code, ErrorCode::malformed_input);
  EXPECT_EQ(decoded.error().message.substr(0, 7), "part 1:");
}

/// Whatever the bytes, the answer is a mesh with indices in range or an error.
TEST(DecodeLevel, DamagedBytesNeverCrash) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  const IndexedMesh mesh = test::random_shapes(random, 3);
  VertexAttributes attributes = test::attributes_of(mesh.positions);
  attributes.normal = test::normals_of(mesh.positions);
  const auto encoded = encode_level(mesh, attributes, {.position_bits = 12, .max_part_triangles = 60});
  ASSERT_TRUE(encoded);
  for (int trial = 0; trial < 500; ++trial) {
    EncodedLevel damaged = *encoded;
    std::vector<std::byte>& bytes = damaged.parts[random() % damaged.parts.size()].bytes;
    for (auto flips = random() % 4 + 1; flips > 0; --flips) bytes[random() % bytes.size()] = std::byte(random() % 256);
    if (trial % 8 == 0) bytes.resize(random() % bytes.size());
    const auto decoded = decode_level(bytes_of(damaged));
    if (!decoded) continue;
    for (const Triangle& triangle : decoded->mesh.triangles) {
      for (const std::int32_t v : triangle) ASSERT_LT(static_cast<std::size_t>(v), decoded->mesh.positions.size());
    }
  }
}

/// Debian's own reader of the files we write.
TEST(EncodeLevel, DebiansDecoderReadsEveryPart) {
#ifndef GEOSIS_DRACO_DECODER
  GTEST_SKIP() << "draco_decoder is not installed";
#else
  const auto folder = std::filesystem::path(testing::TempDir()) / "geosis_codec_test";
  std::filesystem::create_directories(folder);
  const auto encoded = encode_level(test::sphere({32, 32, 32}, 20, 12, 16), {}, {.max_part_triangles = 100});
  ASSERT_TRUE(encoded);
  ASSERT_GT(encoded->parts.size(), 1u);
  for (const EncodedPart& part : encoded->parts) {
    const std::string drc = folder / "part.drc", obj = folder / "part.obj";
    std::ofstream(drc, std::ios::binary)
        .write(reinterpret_cast<const char*>(part.bytes.data()), static_cast<std::streamsize>(part.bytes.size()));
    const std::string command = GEOSIS_DRACO_DECODER " -i '" + drc + "' -o '" + obj + "' > /dev/null";
    ASSERT_EQ(std::system(command.c_str()), 0) << command;
    std::ifstream file(obj);
    std::int64_t faces = 0;
    for (std::string line; std::getline(file, line);) faces += line.rfind("f ", 0) == 0;
    EXPECT_EQ(faces, part.triangles);
  }
  std::filesystem::remove_all(folder);
#endif
}

}  // namespace
}  // namespace geosis
