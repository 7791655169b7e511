#include "engine/analysis/surface_measures.h"

#include <vector>

#include "engine/base/vec3.h"

namespace geosis {
namespace {

Vec3d apply_linear_part(const std::array<double, 16>& m, Vec3d d) {
  return {m[0] * d.x + m[1] * d.y + m[2] * d.z, m[4] * d.x + m[5] * d.y + m[6] * d.z,
          m[8] * d.x + m[9] * d.y + m[10] * d.z};
}

/// World positions minus that of the first vertex. An affine map is applied to the difference of the indices, which is
/// exact, so that the origin never enters.
std::vector<Vec3d> map_relative_to_first(const std::vector<Vec3f>& positions, const GridGeometry& geometry) {
  const Vec3d first = to_double(positions.front());
  const Vec3d mapped_first = geometry.map(first);
  const std::array<double, 16>* matrix = geometry.affine();
  std::vector<Vec3d> mapped;
  mapped.reserve(positions.size());
  for (const Vec3f position : positions) {
    const Vec3d index = to_double(position);
    mapped.push_back(matrix != nullptr ? apply_linear_part(*matrix, index - first)
                                       : geometry.map(index) - mapped_first);
  }
  return mapped;
}

}  // namespace

SurfaceMeasures measure_surface(const IndexedMesh& mesh, const GridGeometry& geometry) {
  if (mesh.positions.empty()) return {};
  const std::vector<Vec3d> world = map_relative_to_first(mesh.positions, geometry);
  double twice_area = 0, six_volumes = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3d normal = cross(world[b] - world[a], world[c] - world[a]);
    twice_area += norm(normal);
    six_volumes += dot(world[a], normal);
  }
  return {twice_area / 2, six_volumes / 6};
}

}  // namespace geosis
