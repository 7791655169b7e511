#pragma once

#include "engine/isosurface/labelled_surface.h"

namespace geosis {

/// After the mesh's vertices have been moved: volume_voxels anew from where they are now, and the bodies numbered by
/// falling volume again. Without volumes (an open surface) they are ordered by their samples' voxels.
///
/// capped     the surfaces are closed.
/// mirrored   as ExtractOptions has it.
void renumber_bodies(LabelledSurface& surface, bool capped, bool mirrored);

}  // namespace geosis
