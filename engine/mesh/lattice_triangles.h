#pragma once

#include <array>
#include <cstdint>

#include "engine/base/vec3.h"

namespace geosis {

/// A point of the lattice, in lattice steps.
using LatticePoint = Vec3<std::int64_t>;
using LatticeTriangle = std::array<LatticePoint, 3>;

/// Whether two triangles have a point in common outside the corners and edges that they share (by position). Exact.
///
/// Coordinates less than 2^24 steps from the origin. Triangles without area meet nothing.
bool triangles_intersect(const LatticeTriangle& s, const LatticeTriangle& t);

}  // namespace geosis
