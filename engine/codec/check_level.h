#pragma once

#include "engine/base/result.h"
#include "engine/codec/level_codec.h"

namespace geosis {

/// Everything that Draco would throw on, crash on or change silently, refused by name (see encode_level's errors).
///
/// cost   one pass over positions, triangles and attributes, about 1 % of encoding.
Result<void> check_level(const IndexedMesh& mesh, const VertexAttributes& attributes, const EncodeOptions& options);

}  // namespace geosis
