#include "engine/analysis/surface_measures.h"

#include <vector>

#include "engine/base/stretches.h"
#include "engine/base/vec3.h"

namespace geosis {
namespace {

Error cancelled() {
  return {ErrorCode::cancelled, "measuring a surface was cancelled"};
}

Vec3d apply_linear_part(const std::array<double, 16>& m, Vec3d d) {
  return {m[0] * d.x + m[1] * d.y + m[2] * d.z, m[4] * d.x + m[5] * d.y + m[6] * d.z,
          m[8] * d.x + m[9] * d.y + m[10] * d.z};
}

/// World positions minus that of the first vertex. An affine map is applied to the difference of the indices, which is
/// exact, so that the origin never enters.
Result<std::vector<Vec3d>> map_relative_to_first(const std::vector<Vec3f>& positions, const GridGeometry& geometry,
                                                 const Progress& progress) {
  const Vec3d first = to_double(positions.front());
  const Vec3d mapped_first = geometry.map(first);
  const std::array<double, 16>* matrix = geometry.affine();
  std::vector<Vec3d> mapped;
  mapped.reserve(positions.size());
  Stretches stretches(positions.size(), progress);
  while (stretches.next()) {
    for (std::size_t v = stretches.begin(); v < stretches.end(); ++v) {
      const Vec3d index = to_double(positions[v]);
      mapped.push_back(matrix != nullptr ? apply_linear_part(*matrix, index - first)
                                         : geometry.map(index) - mapped_first);
    }
  }
  if (stretches.are_cancelled()) return cancelled();
  return mapped;
}

}  // namespace

Result<SurfaceMeasures> measure_surface(const IndexedMesh& mesh, const GridGeometry& geometry,
                                        const Progress& progress) {
  if (mesh.positions.empty()) return SurfaceMeasures{};
  const auto mapped = map_relative_to_first(mesh.positions, geometry, progress);
  if (!mapped) return mapped.error();
  const std::vector<Vec3d>& world = *mapped;
  double twice_area = 0, six_volumes = 0;
  Stretches stretches(mesh.triangles.size(), progress);
  while (stretches.next()) {
    for (std::size_t t = stretches.begin(); t < stretches.end(); ++t) {
      const auto& [a, b, c] = mesh.triangles[t];
      const Vec3d normal = cross(world[b] - world[a], world[c] - world[a]);
      twice_area += norm(normal);
      six_volumes += dot(world[a], normal);
    }
  }
  if (stretches.are_cancelled()) return cancelled();
  return SurfaceMeasures{twice_area / 2, six_volumes / 6};
}

SurfaceMeasures measure_surface(const IndexedMesh& mesh, const GridGeometry& geometry) {
  return *measure_surface(mesh, geometry, NoProgress());
}

}  // namespace geosis
