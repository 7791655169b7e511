#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/simplify/buffer.h"
#include "engine/simplify/rings.h"
#include "engine/simplify/working_mesh.h"

namespace geosis {

/// The mesh cut into windows: runs of `window_size` vertices in the Morton order of a grid of cells.
///
/// A function of mesh, window size and pass alone. The grid moves (cyclically, by an irrational share) from pass to
/// pass: with one grid the octant planes would be seams of every pass.
struct Partition {
  std::int32_t window_size = 0;
  std::int32_t windows = 0;
  Buffer<std::int32_t> order;               ///< place in Morton order -> vertex of the mesh
  std::vector<std::uint8_t> locked;         ///< by place: a triangle of this vertex leaves the window
  Buffer<LocalTriangle> triangles;          ///< those inside a window, over places relative to the window's first
  std::vector<std::size_t> first_triangle;  ///< (windows + 1)
  Buffer<Triangle> crossing;                ///< the others, over places, at the window of their first vertex
  std::vector<std::size_t> first_crossing;  ///< (windows + 1)

  std::int32_t first_vertex(std::int32_t window) const { return window * window_size; }
  std::int32_t vertices(std::int32_t window) const;
  std::span<LocalTriangle> triangles_of(std::int32_t window) {
    return {&triangles[first_triangle[window]], first_triangle[window + 1] - first_triangle[window]};
  }
  std::span<Triangle> crossing_of(std::int32_t window) {
    return {&crossing[first_crossing[window]], first_crossing[window + 1] - first_crossing[window]};
  }
};

/// window_size   a power of two up to Window::kMaxVertices. A mesh that fits one window keeps its order.
Partition make_partition(const WorkingMesh& mesh, std::int32_t window_size, std::uint32_t pass, int threads);

}  // namespace geosis
