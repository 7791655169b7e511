#include "engine/codec/draco_part.h"

#include <algorithm>
#include <random>
#include <string>
#include <vector>

#include <draco/compression/decode.h>
#include <draco/compression/expert_encode.h>
#include <draco/point_cloud/point_cloud_builder.h>
#include <gtest/gtest.h>

#include "tests/support/lattice_meshes.h"

namespace geosis {
namespace {

std::unique_ptr<draco::Mesh> read_with_draco(const EncodedPart& part) {
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(part.bytes.data()), part.bytes.size());
  return draco::Decoder().DecodeMeshFromBuffer(&buffer).value();
}

MeshPart box_part() {
  return {test::box({1, 2, 3}, {4, 5, 6}), {0, 0, 1, 2, 0, 3, 0, 900'000}};
}

TEST(EncodePart, TransformTravelsAsDoublesInTheMetadata) {
  EncodeOptions options;
  for (int entry = 0; entry < 16; ++entry) options.transform[entry] = 6'543'210.123456789 / (entry + 1);
  const auto mesh = read_with_draco(*encode_part(box_part(), options));
  std::vector<double> transform;
  ASSERT_TRUE(mesh->GetMetadata()->GetEntryDoubleArray("transform", &transform));
  EXPECT_TRUE(std::equal(transform.begin(), transform.end(), options.transform.begin(), options.transform.end()));
}

/// Positions that are all the same take no bytes worth speaking of, so that connectivity is what remains. Standard
/// edgebreaker (speed 10) writes 1 bit for half of the triangles and 3 for the others, whatever the mesh; valence
/// coding gets below it.
TEST(EncodeMesh, ConnectivityTakesLessThanTwoBitsATriangle) {
  IndexedMesh mesh = test::torus({32, 32, 32}, 15, 6, 200, 150);
  std::fill(mesh.positions.begin(), mesh.positions.end(), Vec3f{});
  const auto bits = [&](int speed) {
    const auto bytes = encode_mesh(mesh, {}, {}, {.speed = speed});
    return 8 * static_cast<double>(bytes->size()) / static_cast<double>(mesh.triangles.size());
  };
  EXPECT_LT(bits(10), 2.05);
  EXPECT_LT(bits(7), 1.0);
  EXPECT_LT(bits(4), 1.0);
}

TEST(EncodePart, SeamIdsAreAGenericAttributeNamedSeam) {
  const auto mesh = read_with_draco(*encode_part(box_part(), {}));
  const int seam = mesh->GetAttributeIdByMetadataEntry("name", "seam");
  ASSERT_GE(seam, 0);
  EXPECT_EQ(mesh->attribute(seam)->attribute_type(), draco::GeometryAttribute::GENERIC);
  EXPECT_EQ(mesh->attribute(seam)->data_type(), draco::DT_UINT32);
}

TEST(EncodePart, WithoutSeamsThereIsOnlyThePosition) {
  const auto mesh = read_with_draco(*encode_part({box_part().mesh, {}}, {}));
  EXPECT_EQ(mesh->num_attributes(), 1);
}

TEST(EncodePart, AttributesAreGenericUnderTheirNames) {
  MeshPart part = box_part();
  part.attributes = {{1, 2, 3, 4, 5, 6, 7, 8}, {1, 1, 1, 1, 2, 2, 2, 2}, {0, 1, 2, 3, 4, 5, 6, 7}};
  const auto mesh = read_with_draco(*encode_part(part, {}));
  for (const auto& [name, type] :
       {std::pair{"reliability", draco::DT_UINT8}, {"body", draco::DT_UINT32}, {"value", draco::DT_FLOAT32}}) {
    const int id = mesh->GetAttributeIdByMetadataEntry("name", name);
    ASSERT_GE(id, 0) << name;
    EXPECT_EQ(mesh->attribute(id)->attribute_type(), draco::GeometryAttribute::GENERIC);
    EXPECT_EQ(mesh->attribute(id)->data_type(), type);
    EXPECT_EQ(mesh->attribute(id)->num_components(), 1);
  }
}

TEST(DecodePart, SeamIdsStayWithTheirVertices) {
  const MeshPart part = box_part();
  const auto decoded = decode_part(encode_part(part, {})->bytes);
  ASSERT_TRUE(decoded) << decoded.error().message;
  ASSERT_EQ(decoded->seams.size(), 8u);
  for (std::size_t v = 0; v < 8; ++v) {
    const auto& original = part.mesh.positions;
    const auto at = std::find(original.begin(), original.end(), decoded->mesh.positions[v]) - original.begin();
    EXPECT_EQ(decoded->seams[v], part.seams[at]);
  }
}

TEST(DecodePart, RefusesBytesThatAreNotDraco) {
  for (const std::string text : {"", "DRACO", "not a mesh at all, but long enough to hold a header"}) {
    const auto decoded = decode_part(std::as_bytes(std::span(text)));
    ASSERT_FALSE(decoded) << text;
    EXPECT_EQ(decoded.error().code, ErrorCode::malformed_input);
  }
}

TEST(DecodePart, RefusesAPointCloud) {
  draco::PointCloudBuilder builder;
  builder.Start(1);
  const int position = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
  const Vec3f point = {1, 2, 3};
  builder.SetAttributeValueForPoint(position, draco::PointIndex(0), &point);
  const auto cloud = builder.Finalize(false);
  draco::EncoderBuffer buffer;
  ASSERT_TRUE(draco::ExpertEncoder(*cloud).EncodeToBuffer(&buffer).ok());
  const auto decoded = decode_part(std::as_bytes(std::span(buffer.data(), buffer.size())));
  ASSERT_FALSE(decoded);
  EXPECT_EQ(decoded.error().code, ErrorCode::malformed_input);
}

TEST(DecodePart, TruncatedFilesAreRefusedAtEveryLength) {
  const auto encoded = encode_part(box_part(), {});
  for (std::size_t length = 0; length < encoded->bytes.size(); ++length) {
    EXPECT_FALSE(decode_part(std::span(encoded->bytes).first(length))) << length;
  }
}

}  // namespace
}  // namespace geosis
