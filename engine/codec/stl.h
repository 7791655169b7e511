#pragma once

#include <ostream>

#include "engine/base/result.h"
#include "engine/codec/position_map.h"
#include "engine/mesh/indexed_mesh.h"

namespace geosis {

/// The mesh as binary STL: for each triangle its unit normal and its three mapped positions minus `origin`, which the
/// 80-byte header names; subtracted in double, stored as float32.
///
/// A triangle without area has the normal (0, 0, 0).
///
/// errors   limit_exceeded: more than 2^32 - 1 triangles.  unavailable: the stream refuses bytes (a full disk).
/// cost     50 bytes a triangle; memory: one buffer, whatever the size of the mesh.
Result<void> write_stl(std::ostream& stream, const IndexedMesh& mesh, const PositionMap& to_space, Vec3d origin);

}  // namespace geosis
