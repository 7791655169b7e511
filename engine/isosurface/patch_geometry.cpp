#include "engine/isosurface/patch_geometry.h"

#include <algorithm>

#include "engine/mesh/indexed_mesh.h"

namespace geosis {

bool patch_cuts_itself(std::span<const std::uint8_t> corners, const CellPoints& points) {
  const auto triangle = [&](std::size_t n) -> LatticeTriangle {
    return {points[corners[n]], points[corners[n + 1]], points[corners[n + 2]]};
  };
  for (std::size_t a = 0; a < corners.size(); a += 3) {
    for (std::size_t b = a + 3; b < corners.size(); b += 3) {
      if (triangles_intersect(triangle(a), triangle(b))) return true;
    }
  }
  return false;
}

LatticePoint inner_point(const Mc33TunnelPatch& patch, const CellPoints& points, int sheet) {
  const LatticePoint a = points[patch.chord[0]], b = points[patch.chord[1]];
  LatticePoint middle;
  for (int axis = 0; axis < 3; ++axis) {
    middle[axis] = std::clamp<std::int64_t>((a[axis] + b[axis]) / 2, 1, kLatticeStepsPerVoxel - 1);
  }
  const int axis = cell::face_axis(patch.face);
  const auto place_at = [&](int depth) {
    middle[axis] = cell::face_side(patch.face) == 1 ? kLatticeStepsPerVoxel - depth : depth;
  };
  place_at(patch.depth);
  if (((middle.x + middle.y + middle.z) & 1) != sheet) place_at(patch.depth + 1);
  return middle;
}

}  // namespace geosis
