#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "engine/analysis/topology_report.h"
#include "engine/codec/level_codec.h"
#include "tests/support/lattice_meshes.h"

namespace geosis::test {

inline std::vector<std::span<const std::byte>> bytes_of(const EncodedLevel& level) {
  std::vector<std::span<const std::byte>> parts;
  for (const EncodedPart& part : level.parts) parts.emplace_back(part.bytes);
  return parts;
}

/// Attributes that tell which position they belong to: full range of each type, NaN and -0 among the values.
inline VertexAttributes attributes_of(const std::vector<Vec3f>& positions) {
  VertexAttributes attributes;
  for (const Vec3f p : positions) {
    std::uint32_t hash = 0;
    for (const float x : {p.x, p.y, p.z}) hash = (hash ^ std::bit_cast<std::uint32_t>(x)) * 2'654'435'761u;
    attributes.reliability.push_back(static_cast<std::uint8_t>(hash >> 24));
    attributes.body.push_back(hash % 5 == 0 ? kMaxBody - hash % 3 : hash % 7);
    const float value = hash % 4 == 0 ? std::numeric_limits<float>::quiet_NaN() : hash % 4 == 1 ? -0.0f : 1e30f * p.x;
    attributes.value.push_back(value);
  }
  return attributes;
}

/// Unit vectors that tell which position they belong to.
inline std::vector<Vec3f> normals_of(const std::vector<Vec3f>& positions) {
  std::vector<Vec3f> normals;
  for (const Vec3f p : positions) {
    const Vec3f arm = p - Vec3f{31.3f, 30.1f, 29.7f};
    normals.push_back(arm * (1 / norm(arm)));
  }
  return normals;
}

/// Bit for bit, so that NaN equals itself and 0 is not -0.
inline void expect_same_attributes(const VertexAttributes& found, const VertexAttributes& expected) {
  EXPECT_EQ(found.reliability, expected.reliability);
  EXPECT_EQ(found.body, expected.body);
  ASSERT_EQ(found.value.size(), expected.value.size());
  EXPECT_EQ(std::memcmp(found.value.data(), expected.value.data(), expected.value.size() * sizeof(float)), 0);
}

/// Encodes, decodes and compares: the same triangles on bit-equal positions, connected in the same way.
inline void expect_round_trip(const IndexedMesh& mesh, const EncodeOptions& options) {
  const auto encoded = encode_level(mesh, {}, options);
  ASSERT_TRUE(encoded) << encoded.error().message;
  const auto decoded = decode_level(bytes_of(*encoded));
  ASSERT_TRUE(decoded) << decoded.error().message;
  EXPECT_EQ(triangle_multiset(decoded->mesh), triangle_multiset(mesh));
  EXPECT_TRUE(report_topology(decoded->mesh) == report_topology(mesh));
}

}  // namespace geosis::test
