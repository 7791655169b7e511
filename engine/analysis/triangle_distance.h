#pragma once

#include "engine/base/vec3.h"

namespace geosis {

/// Exact squared distance from a point to a triangle, which may be a segment or a point.
double squared_distance_to_triangle(Vec3d point, Vec3d a, Vec3d b, Vec3d c);

}  // namespace geosis
