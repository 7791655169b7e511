#pragma once

#include <vector>

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/codec/level_codec.h"
#include "engine/codec/mesh_part.h"

namespace geosis {

/// One level from the parts of a level: vertices with the same seam id become one, all others stay apart.
///
/// returns  triangles part after part; vertices numbered by their first appearance.
/// errors   malformed_input: two positions or two values of an attribute under one seam id (compared bit for bit), an
///          attribute that some parts have and others lack, an id that only one part has, an id beyond the number of
///          vertices, a triangle that the join collapses, more than 2^31 - 1 vertices.
///          cancelled.
Result<DecodedLevel> join_parts(std::vector<MeshPart> parts, const Progress& progress = NoProgress());

}  // namespace geosis
