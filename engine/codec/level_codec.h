#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/base/result.h"
#include "engine/mesh/indexed_mesh.h"

namespace geosis {

struct EncodeOptions {
  int position_bits = 14;  ///< ceil(log2(longest axis in voxels)) + 6: the lattice covers the volume
  std::int32_t max_part_triangles = 100'000;
  int speed = 7;                       ///< Draco's 0 (small) .. 10 (fast)
  std::array<double, 16> transform{};  ///< index to output space, row-major; travels as Draco metadata
  int threads = 1;
};

/// One Draco file. Its vertices lie on the lattice; vertices shared with other parts of the level carry the same
/// non-zero seam id in both.
struct EncodedPart {
  std::vector<std::byte> bytes;
  std::int64_t triangles = 0;
};

struct EncodedLevel {
  std::vector<EncodedPart> parts;
};

/// Bits that hold every lattice position of a volume whose longest axis has that many samples.
int position_bits_for(std::int32_t longest_axis_samples);

/// The level as Draco files of at most max_part_triangles each, cut along the order of the triangles (Morton bricks).
///
/// mesh     positions on the 1/64 lattice, 0 <= position < 2^(bits - 6).
/// errors   invalid_argument: a position that is not finite, off the lattice or out of range, a bad index, no
/// triangles.
Result<EncodedLevel> encode_level(const IndexedMesh& mesh, const EncodeOptions& options);

/// The parts decoded and joined along their seams by seam id: what a client sees, and what the certificate describes.
///
/// errors   malformed_input: bytes that Draco refuses, or parts that disagree on a seam.
Result<IndexedMesh> decode_level(const std::vector<std::span<const std::byte>>& parts);

}  // namespace geosis
