#pragma once

#include <limits>
#include <ostream>

#include "engine/base/result.h"
#include "engine/codec/level_codec.h"

namespace geosis {

/// What stands for a missing `value` in a GLB, where NaN is not allowed.
inline constexpr float kGlbMissingValue = std::numeric_limits<float>::lowest();

/// The level as one binary glTF 2.0 file: one mesh, whole, compressed by KHR_draco_mesh_compression.
///
/// Positions   index coordinates, the same lattice positions as in the .drc files. The node's matrix is the linear part
///             of options.transform and the way to glTF's axes, (x, y, z) -> (x, -z, -y): x east, y up, z south. The
///             vertical axis points down in the survey and up in glTF, so that way is a mirror. A transform with shear
///             takes two nodes. What float32 could not hold stays out of the matrices: the node's extras have "origin",
///             the position in the space of the mesh's (0, 0, 0), and the whole "transform", both in double.
/// Triangles   face outwards by glTF's rule, which looks at the sign of the matrix.
/// Attributes  _RELIABILITY: normalised unsigned byte, 1 = measured.
///             _BODY: unsigned short when all ids fit, else float, for glTF has no 32-bit integers at vertices.
///             _AGREEMENT: normalised unsigned byte.
///             _VALUE: float; NaN and infinities are kGlbMissingValue, also named in the primitive's extras.
///             NORMAL, when the level has normals; otherwise readers shade flat, as glTF asks of them.
///
/// mesh, attributes, options   as for encode_level; max_part_triangles and threads have no meaning here.
/// errors   those of encode_level; limit_exceeded: a body id above 2^24, which float cannot hold exactly, or a file of
///          4 GiB; unavailable: the stream refuses bytes.
/// cost     that of encode_level and decode_level on one thread.
Result<void> write_glb(std::ostream& stream, const IndexedMesh& mesh, const VertexAttributes& attributes,
                       const EncodeOptions& options);

}  // namespace geosis
