#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "engine/base/vec3.h"

namespace geosis {

using Triangle = std::array<std::int32_t, 3>;

/// Spacing of the lattice that every vertex of every level lies on, in voxels (index units). A power of two, so that
/// float32 holds lattice positions exactly up to 2^17 voxels an axis.
inline constexpr float kLatticeStep = 1.0f / 64.0f;
inline constexpr int kLatticeStepsPerVoxel = 64;

/// Triangles over shared vertices.
///
/// positions (n), float32 index coordinates (inline, crossline, sample) on the lattice;
/// triangles (m) of indices into positions; seen from outside the body, counter-clockwise.
struct IndexedMesh {
  std::vector<Vec3f> positions;
  std::vector<Triangle> triangles;
};

}  // namespace geosis
