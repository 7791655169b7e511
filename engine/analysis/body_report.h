#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/base/result.h"
#include "engine/base/vec3.h"
#include "engine/mesh/indexed_mesh.h"
#include "engine/volume/geometry.h"

namespace geosis {

/// One body, as the surfaces that bound it tell. Lengths are the geometry's, but for volume_voxels.
struct BodyReport {
  std::int64_t vertices = 0, triangles = 0;
  std::int64_t components = 0;  ///< surfaces: the outer one and those of cavities
  std::int64_t cavities = 0;    ///< closed surfaces that enclose a negative volume
  std::int64_t genus = 0;       ///< sum over the surfaces, each closed over its boundary loops
  double volume = 0, area = 0;
  double volume_voxels = 0;  ///< in index units, exact for vertices on the lattice
  Vec3d low{}, high{};       ///< box around the vertices; zero without vertices
  Vec3d centroid{};          ///< of the solid; of the vertices where it encloses no volume
  /// Of the vertices whose reliability is below 255: not between measured samples only. 0 without reliabilities.
  double interpolated_share = 0;
};

/// mesh         manifold, perhaps with boundary; when the geometry mirrors, its triangles are ordered for the mapped
///              mesh, as extract_body does. Volumes and centroids are meaningful for closed surfaces.
/// body         (n) which body each vertex bounds, below `bodies`; the same for the vertices of a triangle.
/// reliability  (n), or empty.
/// returns      [body]; sums run in double in the order of the triangles, on positions relative to the body's first
///              vertex: neither a far origin nor a far body costs digits.
/// errors       invalid_argument: labels or reliabilities that do not fit the mesh; a mesh without a corner table.
/// cost         O(triangles log valence).
Result<std::vector<BodyReport>> report_bodies(const IndexedMesh& mesh, std::span<const std::uint32_t> body,
                                              std::size_t bodies, const GridGeometry& geometry,
                                              std::span<const std::uint8_t> reliability = {});

}  // namespace geosis
