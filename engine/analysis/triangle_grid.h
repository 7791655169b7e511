#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "engine/base/progress.h"
#include "engine/base/vec3.h"
#include "engine/mesh/indexed_mesh.h"

namespace geosis {

struct NearestTriangle {
  double squared_distance = 0;
  std::int32_t triangle = -1;  ///< -1 = none yet
};

/// Triangles sorted into a uniform grid of cubic cells, to find the one nearest to a point. Keeps a reference to the
/// mesh, which must have triangles and outlive it.
///
/// cost   building O(triangles); cells are a few triangles wide, at most about two cells a triangle and 2,000.
class TriangleGrid {
 public:
  explicit TriangleGrid(const IndexedMesh& mesh, const Progress& progress = NoProgress());

  /// False: building it was cancelled, and nothing can be found in it.
  bool is_built() const { return is_built_; }

  /// The triangle nearest to the point, anywhere in space, and the exact squared distance to it.
  /// guess   a triangle that is likely near, to start from; -1 when there is none.
  NearestTriangle find_nearest(Vec3d point, std::int32_t guess) const;

 private:
  using Cell = std::array<std::int32_t, 3>;
  class PlaneColumns;

  // Of building, each false when it is cancelled.
  bool find_box(const Progress& progress);
  bool choose_cell_size(const Progress& progress);
  bool sort_triangles_into_cells(const Progress& progress);
  /// Nothing when it is cancelled.
  std::optional<std::size_t> count_triangles_in_cells(const Progress& progress);
  template <class Visit>
  void for_each_cell_of(const Triangle& triangle, const Visit& visit) const;

  /// The nearest cell when the point lies outside.
  std::int32_t cell_along(int axis, double coordinate) const;
  Cell cell_at(Vec3d point) const;
  std::size_t number_of(Cell cell) const {
    return (static_cast<std::size_t>(cell[0]) * shape_[1] + cell[1]) * shape_[2] + cell[2];
  }
  double squared_distance_to_cell(Vec3d point, Cell cell) const;
  double distance_to_shell(Vec3d point, Cell center, std::int32_t radius) const;
  void search_cell(Vec3d point, Cell cell, NearestTriangle& nearest) const;
  void search_shell(Vec3d point, Cell center, std::int32_t radius, NearestTriangle& nearest) const;
  void consider(Vec3d point, std::int32_t triangle, NearestTriangle& nearest) const;

  const IndexedMesh& mesh_;
  Vec3d low_, high_;  ///< bounding box of the triangles
  double cell_size_ = 1, cells_per_unit_ = 1;
  Cell shape_{1, 1, 1};
  std::vector<std::uint32_t> first_;     ///< (cells + 1) where each cell's triangles start
  std::vector<std::int32_t> triangles_;  ///< the cells' triangles, cell after cell
  bool is_built_ = false;
};

}  // namespace geosis
