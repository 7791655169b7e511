#pragma once

#include <utility>
#include <vector>

#include "engine/mesh/indexed_mesh.h"

namespace geosis::tiny {

// Meshes small enough to draw. Positions do not matter for connectivity, so all vertices lie at the origin.

inline IndexedMesh mesh(std::size_t vertices, std::vector<Triangle> triangles) {
  return {std::vector<Vec3f>(vertices), std::move(triangles)};
}

///   3---2
///   | / |
///   0---1
inline IndexedMesh square() {
  return mesh(4, {{0, 1, 2}, {0, 2, 3}});
}

inline IndexedMesh tetrahedron() {
  return mesh(4, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}});
}

///   1       4
///   | \   / |
///   |   0   |      two triangles that meet in vertex 0 only
///   | /   \ |
///   2       3
inline IndexedMesh bow_tie() {
  return mesh(5, {{0, 1, 2}, {0, 3, 4}});
}

/// A rows x columns grid of quads whose opposite sides are the same: a torus.
inline IndexedMesh torus(int rows, int columns) {
  std::vector<Triangle> triangles;
  const auto at = [&](int r, int c) { return (r % rows) * columns + c % columns; };
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < columns; ++c) {
      triangles.push_back({at(r, c), at(r, c + 1), at(r + 1, c + 1)});
      triangles.push_back({at(r, c), at(r + 1, c + 1), at(r + 1, c)});
    }
  }
  return mesh(static_cast<std::size_t>(rows) * columns, std::move(triangles));
}

/// A band around a cylinder: two boundary loops.
///   3---4---5---3
///   | / | / | / |
///   0---1---2---0
inline IndexedMesh band() {
  return mesh(6, {{0, 1, 4}, {0, 4, 3}, {1, 2, 5}, {1, 5, 4}, {2, 0, 3}, {2, 3, 5}});
}

}  // namespace geosis::tiny
