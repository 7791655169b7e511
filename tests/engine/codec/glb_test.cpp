#include "engine/codec/glb.h"

#include <sstream>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "engine/codec/draco_part.h"
#include "tests/engine/codec/codec_checks.h"

namespace geosis {
namespace {

using Json = nlohmann::json;

const IndexedMesh kMesh = test::torus({32, 32, 32}, 15, 6, 32, 20);
const EncodeOptions kOptions = {.transform = {25, 0, 0, 6'543'210.7, 0, 12.5, 0, 432'100.1, 0, 0, 4, -5, 0, 0, 0, 1}};

struct Glb {
  Json json;
  std::string bin;
};

std::uint32_t word(const std::string& bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (int byte = 3; byte >= 0; --byte) value = value << 8 | static_cast<unsigned char>(bytes.at(at + byte));
  return value;
}

Glb read_glb(const std::string& bytes) {
  EXPECT_EQ(bytes.substr(0, 4), "glTF");
  EXPECT_EQ(word(bytes, 4), 2u);
  EXPECT_EQ(word(bytes, 8), bytes.size());
  const std::size_t json_bytes = word(bytes, 12), bin_bytes = word(bytes, 20 + json_bytes);
  EXPECT_EQ(bytes.substr(16, 4), "JSON");
  EXPECT_EQ(bytes.substr(24 + json_bytes, 4), std::string("BIN\0", 4));
  EXPECT_EQ(28 + json_bytes + bin_bytes, bytes.size());
  EXPECT_EQ(json_bytes % 4, 0u);
  EXPECT_EQ(bin_bytes % 4, 0u);
  return {Json::parse(bytes.substr(20, json_bytes)), bytes.substr(28 + json_bytes)};
}

Glb written(const IndexedMesh& mesh, const VertexAttributes& attributes, const EncodeOptions& options = kOptions) {
  std::stringstream stream;
  const auto done = write_glb(stream, mesh, attributes, options);
  EXPECT_TRUE(done) << done.error().message;
  return read_glb(stream.str());
}

IndexedMesh decoded(const Glb& glb) {
  const auto part = decode_part(
      std::as_bytes(std::span(glb.bin)).first(glb.json.at("bufferViews").at(0).at("byteLength").get<std::size_t>()));
  EXPECT_TRUE(part) << part.error().message;
  return part->mesh;
}

const Json& accessor(const Glb& glb, const char* name) {
  const Json& primitive = glb.json.at("meshes").at(0).at("primitives").at(0);
  return glb.json.at("accessors").at(primitive.at("attributes").at(name).get<std::size_t>());
}

TEST(WriteGlb, HoldsTheLevelInIndexCoordinates) {
  const Glb glb = written(kMesh, {});
  EXPECT_EQ(test::triangle_multiset(decoded(glb)), test::triangle_multiset(kMesh));
  EXPECT_EQ(accessor(glb, "POSITION").at("count"), kMesh.positions.size());
  EXPECT_EQ(accessor(glb, "POSITION").at("min"), Json({11, 11, 26}));
  EXPECT_EQ(accessor(glb, "POSITION").at("max"), Json({53, 53, 38}));
}

TEST(WriteGlb, BoundsCoverOnlyVerticesThatTrianglesUse) {
  IndexedMesh mesh = kMesh;
  mesh.positions.push_back({100, 100, 100});
  EXPECT_EQ(accessor(written(mesh, {}), "POSITION").at("max"), Json({53, 53, 38}));
}

TEST(WriteGlb, NodeTurnsUpAndKeepsTheOriginInDouble) {
  const Json node = written(kMesh, {}).json.at("nodes").at(0);
  EXPECT_EQ(node.at("matrix"), Json({25, 0, 0, 0, 0, 0, -12.5, 0, 0, -4, 0, 0, 0, 0, 0, 1}));
  EXPECT_EQ(node.at("extras").at("origin"), Json({6'543'210.7, 432'100.1, -5.0}));
  EXPECT_EQ(node.at("extras").at("transform"), Json(kOptions.transform));
}

TEST(WriteGlb, TrianglesOfMirroringTransformsAreTurnedRound) {
  EncodeOptions mirroring = kOptions;
  mirroring.transform[0] = -25;
  IndexedMesh turned = kMesh;
  for (auto& triangle : turned.triangles) std::swap(triangle[1], triangle[2]);
  EXPECT_EQ(test::triangle_multiset(decoded(written(kMesh, {}, mirroring))), test::triangle_multiset(turned));
}

TEST(WriteGlb, ShearTakesASecondNode) {
  EncodeOptions sheared = kOptions;
  sheared.transform[1] = 3;
  const Json nodes = written(kMesh, {}, sheared).json.at("nodes");
  ASSERT_EQ(nodes.size(), 2u);
  EXPECT_EQ(nodes.at(0).at("children"), Json({1}));
  EXPECT_FALSE(nodes.at(0).contains("mesh"));
  EXPECT_EQ(nodes.at(1).at("mesh"), 0);
}

TEST(WriteGlb, AttributesHaveTypesThatGltfAllows) {
  VertexAttributes attributes = test::attributes_of(kMesh.positions);
  attributes.normal = test::normals_of(kMesh.positions);
  for (const auto& [largest, type] : {std::pair{65'535u, 5123}, {65'536u, 5126}, {1u << 24, 5126}}) {
    for (std::uint32_t& body : attributes.body) body %= 7;
    attributes.body[5] = largest;
    const Glb glb = written(kMesh, attributes);
    EXPECT_EQ(accessor(glb, "_BODY").at("componentType"), type);
    EXPECT_EQ(accessor(glb, "_RELIABILITY").at("componentType"), 5121);
    EXPECT_EQ(accessor(glb, "_RELIABILITY").at("normalized"), true);
    EXPECT_EQ(accessor(glb, "_VALUE").at("componentType"), 5126);
    EXPECT_EQ(accessor(glb, "NORMAL").at("type"), "VEC3");
  }
}

TEST(WriteGlb, BodiesThatFloatCannotHoldAreRefused) {
  VertexAttributes attributes{.body = std::vector<std::uint32_t>(kMesh.positions.size(), (1u << 24) + 1)};
  std::stringstream stream;
  const auto done = write_glb(stream, kMesh, attributes, kOptions);
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().code, ErrorCode::limit_exceeded);
}

TEST(WriteGlb, RefusesWhatEncodeLevelRefuses) {
  std::stringstream stream;
  EXPECT_EQ(write_glb(stream, {}, {}, kOptions).error().code, ErrorCode::invalid_argument);
}

TEST(WriteGlb, AFullDiskIsAnError) {
  std::stringstream stream;
  stream.setstate(std::ios::badbit);
  EXPECT_EQ(write_glb(stream, kMesh, {}, kOptions).error().code, ErrorCode::unavailable);
}

}  // namespace
}  // namespace geosis
