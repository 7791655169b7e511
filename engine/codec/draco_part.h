#pragma once

#include <cstddef>
#include <span>

#include "engine/base/result.h"
#include "engine/codec/level_codec.h"
#include "engine/codec/mesh_part.h"

namespace geosis {

/// One part as a Draco file; its form is described at EncodedPart.
///
/// part     checked by check_level: Draco throws on NaN and reads past its arrays on a bad index.
/// errors   internal: Draco failed.
Result<EncodedPart> encode_part(const MeshPart& part, const EncodeOptions& options);

/// The part in a Draco file: any triangle mesh with float32 positions, with or without seam ids and attributes.
///
/// errors   malformed_input: bytes that Draco refuses, another kind of geometry, an index or a position out of bounds,
/// a
///          named attribute of another type.
Result<MeshPart> decode_part(std::span<const std::byte> bytes);

}  // namespace geosis
