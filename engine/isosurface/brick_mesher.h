#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "engine/base/result.h"
#include "engine/isosurface/extract.h"
#include "engine/mesh/indexed_mesh.h"
#include "engine/volume/bricks.h"

namespace geosis {

/// Surface inside one brick, with its own vertex numbers.
///
/// Vertices on a brick's last layer of nodes belong to the next brick. Both bricks number the vertices of a shared
/// layer in the same order, so the n-th of upper_layer[axis] is the n-th of the next brick's lower_layer[axis].
struct BrickMesh {
  std::vector<Vec3f> positions;
  std::vector<Triangle> triangles;
  std::array<std::vector<std::int32_t>, 3> lower_layer, upper_layer;  ///< vertices, in order of creation
};

/// Meshes brick after brick with one set of buffers. One object a thread.
class BrickMesher {
 public:
  BrickMesher(const BrickedVolume& volume, IsoRange range, const ExtractOptions& options);
  ~BrickMesher();
  BrickMesher(const BrickMesher&) = delete;
  BrickMesher& operator=(const BrickMesher&) = delete;

  /// Whether the brick may hold some of the surface: by the index alone.
  bool is_active(std::size_t brick) const;

  /// errors   malformed_input: damaged brick.
  /// cost     one pass over the brick's samples, then O(active cells).
  Result<BrickMesh> mesh(std::size_t brick);

 private:
  class Work;
  std::unique_ptr<Work> work_;
};

}  // namespace geosis
