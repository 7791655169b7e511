#pragma once

#include <functional>

#include "engine/base/vec3.h"

namespace geosis {

/// From index coordinates to the space that a file is written in, for example GridGeometry::map. Files written with
/// an empty map hold index coordinates.
using PositionMap = std::function<Vec3d(Vec3d)>;

}  // namespace geosis
