#pragma once

#include <functional>
#include <optional>

#include "engine/mesh/lod_hierarchy.h"
#include "engine/simplify/reducer.h"

namespace geosis {

/// Takes the reducer as far as the measured distance to M0 allows.
///
/// measure   the distance of a mesh to M0 in voxels.
/// end       set to anything but done when a pass ended so; the result is then of no use.
/// returns   the level; nothing if even the mesh as it is lies farther off.
///
/// A collapse estimates its error; how far the surface then really is from M0 is some multiple of that, which differs
/// from mesh to mesh. So a copy of the reducer goes to a guess, what it made is measured, and the next guess is
/// corrected by the multiple found.
std::optional<LodLevel> reduce_within(Reducer& reducer, double max_error,
                                      const std::function<double(const IndexedMesh&)>& measure, PassEnd& end);

}  // namespace geosis
