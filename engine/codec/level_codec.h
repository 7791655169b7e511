#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/mesh/indexed_mesh.h"
#include "engine/mesh/vertex_attributes.h"

namespace geosis {

/// More bits would not survive Draco's float arithmetic: its rounding adds 0.5 to the node, which float32 cannot
/// represent beyond 2^23. Enough for 131072 samples an axis.
inline constexpr int kMaxPositionBits = 23;

/// The largest body id: Draco adds corrections of up to half the range of ids in int32, and beyond two thirds of that
/// the sums wrap around and other ids come back, without an error.
inline constexpr std::uint32_t kMaxBody = (1u << 30) - 1;

inline constexpr int kNormalBits = 10;

struct EncodeOptions {
  int position_bits = 14;  ///< lattice positions lie in [0, 2^bits - 1] steps; see position_bits_for
  std::int32_t max_part_triangles = 100'000;
  /// Draco's 0 (small) .. 10 (fast). Below 10 connectivity is coded by valence, about 1.1 bits a triangle of a real
  /// surface; at 10 it takes 2 bits and the whole level a tenth more, in three quarters of the time.
  int speed = 7;
  /// Index to output space, row-major; travels as Draco metadata.
  std::array<double, 16> transform = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  int threads = 1;
};

/// One Draco file. Its vertices lie on the lattice; vertices shared with other parts of the level carry the same
/// non-zero seam id in both.
///
/// Attributes  POSITION, 3 x float32: index coordinates, exactly those that were encoded.
///             GENERIC, 1 x uint32, attribute metadata "name" = "seam", only when the level has several parts: 0, or
///             1 + the vertex's rank among the level's seam vertices. A vertex whose triangles in this part form
///             several fans is stored once a fan, each time with its id.
///             GENERIC, attribute metadata "name" = "reliability" (1 x uint8), "body" (1 x uint32) and "value"
///             (1 x float32, bit for bit, NaN included) and "agreement" (1 x uint8), each only when the level has it.
///             NORMAL, 3 x float32, only when the level has normals: in kNormalBits octahedral bits, so that directions
///             change by up to a quarter of a degree; the same at a seam's vertex in all its parts.
/// Metadata    "transform": the 16 numbers of EncodeOptions::transform as little-endian float64 (a double array;
///             readers without one read 32 int32 and reinterpret them).
struct EncodedPart {
  std::vector<std::byte> bytes;
  std::int64_t triangles = 0;
};

struct EncodedLevel {
  std::vector<EncodedPart> parts;
};

struct DecodedLevel {
  IndexedMesh mesh;
  VertexAttributes attributes;  ///< those that the parts carry
};

/// Bits that hold every lattice position of a volume whose longest axis has that many samples: the last node's
/// position, (samples - 1) * 64 steps, included.
int position_bits_for(std::int32_t longest_axis_samples);

/// Bits that hold every position of the mesh.
int position_bits_for(const IndexedMesh& mesh);

/// The level as Draco files of at most max_part_triangles each, cut along the order of the triangles (Morton bricks).
///
/// mesh     manifold with or without boundary, oriented (anything else Draco cuts open without a word); positions on
///          the 1/64 lattice, 0 <= position < 2^(bits - 6). Vertices that no triangle uses are left out.
/// attributes  each array empty or of the mesh's number of vertices; body ids up to kMaxBody, normals of length 1.
/// returns  parts of nearly equal size. The same bytes for any number of threads.
/// errors   invalid_argument: a position that is not finite, off the lattice or out of range, a bad index, no
///          triangles, a triangle with a repeated vertex, attributes that do not fit, options out of range.  internal:
///          Draco failed.  cancelled: asked before each part.
/// cost     about 4 million triangles a second and core; memory: one part a thread + the bytes.
Result<EncodedLevel> encode_level(const IndexedMesh& mesh, const VertexAttributes& attributes,
                                  const EncodeOptions& options, const Progress& progress = NoProgress());

/// The parts decoded and joined along their seams by seam id: what a client sees, and what the certificate describes.
///
/// returns  triangles part after part, in decoding order; vertices numbered by their first appearance.
/// errors   malformed_input: bytes that Draco refuses, no parts, or parts that disagree on a seam or on what they
///          carry. cancelled.
/// cost     about 10 million triangles a second and core.
Result<DecodedLevel> decode_level(const std::vector<std::span<const std::byte>>& parts, int threads = 1,
                                  const Progress& progress = NoProgress());

}  // namespace geosis
