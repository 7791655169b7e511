#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "engine/base/result.h"
#include "engine/codec/level_codec.h"
#include "engine/codec/mesh_part.h"

namespace geosis {

/// One number a vertex, stored under a metadata name. Draco predicts integers and copies float32 bit by bit, for it is
/// not asked to quantise them.
struct NamedNumbers {
  std::string name;
  std::variant<std::span<const std::uint8_t>, std::span<const std::uint16_t>, std::span<const std::uint32_t>,
               std::span<const float>>
      numbers;
};

/// A Draco file of the mesh: attribute 0 is the position, 1, 2, ... are the named numbers, then the normals when there
/// are any.
///
/// mesh     checked by check_level: Draco throws on NaN and reads past its arrays on a bad index.
/// errors   internal: Draco failed.
Result<std::vector<std::byte>> encode_mesh(const IndexedMesh& mesh, const std::vector<NamedNumbers>& named,
                                           const std::vector<Vec3f>& normals, const EncodeOptions& options);

/// One part as a Draco file; its form is described at EncodedPart.
///
/// part     checked by check_level: Draco throws on NaN and reads past its arrays on a bad index.
/// errors   internal: Draco failed.
Result<EncodedPart> encode_part(const MeshPart& part, const EncodeOptions& options);

/// The part in a Draco file: any triangle mesh with float32 positions, with or without seam ids and attributes.
///
/// errors   malformed_input: bytes that Draco refuses, another kind of geometry, an index or a position out of bounds,
///          a named attribute of another type.
Result<MeshPart> decode_part(std::span<const std::byte> bytes);

}  // namespace geosis
