#pragma once

#include <cstdint>
#include <span>

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/mesh/indexed_mesh.h"
#include "engine/mesh/vertex_attributes.h"
#include "engine/missing/file/filled_volume.h"
#include "engine/structure/layer_map.h"
#include "engine/structure/structural_grid.h"
#include "engine/volume/bricks.h"

namespace geosis {

/// Where the vertices of every level take their values from. What is null or empty gives no values.
struct AttributeSources {
  const FilledVolume* filled = nullptr;       ///< reliability
  std::span<const std::uint32_t> body;        ///< of each vertex of M0
  const BrickedVolume* normals = nullptr;     ///< normals: the samples that M0 was extracted from
  GridIndex normals_first = {};               ///< the place of their node (0, 0, 0) in the mesh's coordinates
  bool mirrored = false;                      ///< as the triangles are ordered
  const StructuralGrid* agreement = nullptr;  ///< agreement: the grid that M0 was extracted on
  const BrickedVolume* value = nullptr;       ///< any volume of the shape of the one that M0 was extracted from
  std::span<const Vec3f> places{};  ///< where M0's vertices lie among the samples; empty: where the meshes are
  bool flat_normals = false;        ///< normals: of the triangles, for want of a gradient in the mesh's coordinates
  const LayerMap* rectified =
      nullptr;  ///< set when the meshes are on the rectified grid, and not where the samples are
  int threads = 1;
};

/// Values of a level's vertices: reliability and value at their positions, the body of the vertex of M0 that they
/// descend from.
///
/// origin   of each vertex of the mesh, as LodLevel has it.
/// errors   malformed_input: a damaged brick.  cancelled.
Result<VertexAttributes> attributes_of(const IndexedMesh& mesh, std::span<const std::int32_t> origin,
                                       const AttributeSources& sources, const Progress& progress);

/// Share of the vertices whose reliability says that not only measured samples count there; 0 without reliabilities.
double interpolated_share(std::span<const std::uint8_t> reliability);

}  // namespace geosis
