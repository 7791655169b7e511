// What vertices carry, through the codec and back.

#include <algorithm>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "engine/codec/cut_parts.h"
#include "engine/codec/draco_part.h"
#include "engine/codec/join_parts.h"
#include "tests/engine/codec/codec_checks.h"

namespace geosis {
namespace {

using test::attributes_of;
using test::bytes_of;
using test::expect_same_attributes;

/// Every position occurs once, so that a vertex can be recognised by it.
const IndexedMesh kMesh = test::torus({32, 32, 32}, 15, 6, 30, 20);

DecodedLevel through_codec(const IndexedMesh& mesh, const VertexAttributes& attributes, const EncodeOptions& options) {
  const auto encoded = encode_level(mesh, attributes, options);
  EXPECT_TRUE(encoded) << encoded.error().message;
  auto decoded = decode_level(bytes_of(*encoded));
  EXPECT_TRUE(decoded) << decoded.error().message;
  return *std::move(decoded);
}

TEST(VertexAttributesInLevels, ComeBackExactlyFromWholeLevelsAtEverySpeed) {
  for (int speed = 0; speed <= 10; ++speed) {
    SCOPED_TRACE(speed);
    const auto level = through_codec(kMesh, attributes_of(kMesh.positions), {.position_bits = 13, .speed = speed});
    expect_same_attributes(level.attributes, attributes_of(level.mesh.positions));
    EXPECT_EQ(test::triangle_multiset(level.mesh), test::triangle_multiset(kMesh));
  }
}

TEST(VertexAttributesInLevels, ComeBackExactlyAcrossSeamsAndPinches) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  IndexedMesh mesh = kMesh;
  for (int trial = 0; trial < 10; ++trial) {
    std::shuffle(mesh.triangles.begin(), mesh.triangles.end(), random);
    const auto limit = static_cast<std::int32_t>(1 + random() % 200);
    const auto level = through_codec(mesh, attributes_of(mesh.positions), {.max_part_triangles = limit});
    EXPECT_EQ(level.mesh.positions.size(), mesh.positions.size());
    expect_same_attributes(level.attributes, attributes_of(level.mesh.positions));
  }
}

TEST(VertexAttributesInLevels, EachMayBeThereWithoutTheOthers) {
  for (int present = 0; present < 8; ++present) {
    VertexAttributes attributes = attributes_of(kMesh.positions);
    if ((present & 1) == 0) attributes.reliability.clear();
    if ((present & 2) == 0) attributes.body.clear();
    if ((present & 4) == 0) attributes.value.clear();
    const auto level = through_codec(kMesh, attributes, {.max_part_triangles = 300});
    EXPECT_EQ(level.attributes.reliability.empty(), attributes.reliability.empty());
    EXPECT_EQ(level.attributes.body.empty(), attributes.body.empty());
    EXPECT_EQ(level.attributes.value.empty(), attributes.value.empty());
  }
}

TEST(VertexAttributesInLevels, UniformReliabilityCostsNextToNothing) {
  const VertexAttributes measured{.reliability = std::vector<std::uint8_t>(kMesh.positions.size(), 255)};
  const auto plain = encode_level(kMesh, {}, {}), carrying = encode_level(kMesh, measured, {});
  ASSERT_TRUE(plain && carrying);
  EXPECT_LT(carrying->parts[0].bytes.size(), plain->parts[0].bytes.size() + 60);
}

/// An octahedron of 1023 steps an edge: neighbours are up to a quarter of a degree apart.
void expect_close_normals(const DecodedLevel& level) {
  const auto expected = test::normals_of(level.mesh.positions);
  ASSERT_EQ(level.attributes.normal.size(), expected.size());
  for (std::size_t v = 0; v < expected.size(); ++v) {
    EXPECT_LT(norm(level.attributes.normal[v] - expected[v]), 0.0044f);  // radians
    EXPECT_NEAR(norm(level.attributes.normal[v]), 1, 1e-3);
  }
}

TEST(VertexAttributesInLevels, NormalsComeBackWithinAQuarterOfADegree) {
  for (int speed = 0; speed <= 10; speed += 2) {
    const VertexAttributes attributes{.normal = test::normals_of(kMesh.positions)};
    expect_close_normals(through_codec(kMesh, attributes, {.speed = speed}));
  }
}

/// The join compares normals bit for bit, so that success says that the parts agree.
TEST(VertexAttributesInLevels, NormalsAgreeAlongSeams) {
  for (const int speed : {0, 4, 7, 10}) {
    VertexAttributes attributes = attributes_of(kMesh.positions);
    attributes.normal = test::normals_of(kMesh.positions);
    const auto level = through_codec(kMesh, attributes, {.max_part_triangles = 90, .speed = speed});
    expect_close_normals(level);
    expect_same_attributes(level.attributes, attributes_of(level.mesh.positions));
  }
}

void expect_refused(const VertexAttributes& attributes, const std::string& reason) {
  const auto encoded = encode_level(kMesh, attributes, {});
  ASSERT_FALSE(encoded) << reason;
  EXPECT_EQ(encoded.error().code, ErrorCode::invalid_argument);
  EXPECT_NE(encoded.error().message.find(reason), std::string::npos) << encoded.error().message;
}

TEST(VertexAttributesInLevels, ArraysOfAnotherLengthAreRefused) {
  expect_refused({.reliability = {1}}, "1 values of the attribute reliability for 600 vertices");
  expect_refused({.body = std::vector<std::uint32_t>(601)}, "601 values of the attribute body");
  expect_refused({.value = std::vector<float>(599)}, "599 values of the attribute value");
}

TEST(VertexAttributesInLevels, BodiesBeyondTheLimitAreRefused) {
  VertexAttributes attributes = attributes_of(kMesh.positions);
  attributes.body[7] = kMaxBody + 1;
  expect_refused(attributes, "vertex 7: body 1073741824; at most 1073741823");
}

TEST(VertexAttributesInLevels, NormalsOfAnotherLengthAreRefused) {
  for (const float x : {0.0f, 1.5f, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    VertexAttributes attributes{.normal = test::normals_of(kMesh.positions)};
    attributes.normal[3] = {x, 0, 0};
    expect_refused(attributes, "vertex 3: the normal's length is");
  }
}

/// Two triangles of a square that share the edge with the seam ids 1 and 2.
std::vector<MeshPart> square_in_two_parts() {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  return {{{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}}, {{0, 1, 2}}}, {1, 0, 2}, {{1, 2, 3}, {4, 5, 6}, {nan, 8, 9}}},
          {{{{1, 1, 0}, {0, 1, 0}, {0, 0, 0}}, {{0, 1, 2}}}, {2, 0, 1}, {{3, 20, 1}, {6, 21, 4}, {9, 22, nan}}}};
}

void expect_malformed(std::vector<MeshPart> parts, const std::string& reason) {
  const auto joined = join_parts(std::move(parts));
  ASSERT_FALSE(joined) << reason;
  EXPECT_EQ(joined.error().code, ErrorCode::malformed_input);
  EXPECT_NE(joined.error().message.find(reason), std::string::npos) << joined.error().message;
}

TEST(JoinParts, AttributesFollowTheirVertices) {
  const auto joined = join_parts(square_in_two_parts());
  ASSERT_TRUE(joined) << joined.error().message;
  EXPECT_EQ(joined->attributes.reliability, (std::vector<std::uint8_t>{1, 2, 3, 20}));
  EXPECT_EQ(joined->attributes.body, (std::vector<std::uint32_t>{4, 5, 6, 21}));
  EXPECT_EQ(joined->attributes.value.size(), 4u);
}

TEST(JoinParts, RefusesPartsThatDisagreeOnAnAttribute) {
  auto parts = square_in_two_parts();
  parts[1].attributes.reliability[0] = 4;
  expect_malformed(parts, "part 1 disagrees on the reliability of seam vertex 2");
  parts = square_in_two_parts();
  parts[1].attributes.body[2] = 0;
  expect_malformed(parts, "part 1 disagrees on the body of seam vertex 1");
  parts = square_in_two_parts();
  parts[1].attributes.value[2] = 0;
  expect_malformed(parts, "part 1 disagrees on the value of seam vertex 1");
}

TEST(JoinParts, RefusesAnAttributeThatOnlySomePartsHave) {
  auto parts = square_in_two_parts();
  parts[0].attributes.body.clear();
  expect_malformed(parts, "part 1 alone has the attribute body");
  parts = square_in_two_parts();
  parts[1].attributes.value.clear();
  expect_malformed(parts, "part 1 lacks the attribute value");
}

}  // namespace
}  // namespace geosis
