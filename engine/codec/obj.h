#pragma once

#include <ostream>

#include "engine/base/result.h"
#include "engine/codec/position_map.h"
#include "engine/mesh/indexed_mesh.h"

namespace geosis {

/// The mesh as Wavefront OBJ: `v x y z` lines, the shortest decimals that read back as the same doubles, then `f a b c`
/// lines with 1-based vertex numbers. The same bytes in every locale.
///
/// errors   unavailable: the stream refuses bytes (a full disk).
/// cost     memory: one buffer, whatever the size of the mesh.
Result<void> write_obj(std::ostream& stream, const IndexedMesh& mesh, const PositionMap& to_space);

}  // namespace geosis
