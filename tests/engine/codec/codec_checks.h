#pragma once

#include <cstddef>
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

/// Encodes, decodes and compares: the same triangles on bit-equal positions, connected in the same way.
inline void expect_round_trip(const IndexedMesh& mesh, const EncodeOptions& options) {
  const auto encoded = encode_level(mesh, options);
  ASSERT_TRUE(encoded) << encoded.error().message;
  const auto decoded = decode_level(bytes_of(*encoded));
  ASSERT_TRUE(decoded) << decoded.error().message;
  EXPECT_EQ(triangle_multiset(*decoded), triangle_multiset(mesh));
  EXPECT_TRUE(report_topology(*decoded) == report_topology(mesh));
}

}  // namespace geosis::test
