#pragma once

#include <cstdint>
#include <iosfwd>

#include "engine/mesh/indexed_mesh.h"

namespace geosis::test {

/// Counts over a mesh by index, written apart from engine/mesh so that the two can disagree.
struct MeshCensus {
  std::int64_t vertices = 0;  ///< that a triangle uses
  std::int64_t edges = 0;
  std::int64_t triangles = 0;
  std::int64_t components = 0;
  double volume = 0;  ///< signed; positive when triangles are counter-clockwise from outside

  std::int64_t bad_indices = 0;         ///< triangles with an index out of range or twice the same
  std::int64_t unused_vertices = 0;     ///< that no triangle uses
  std::int64_t border_edges = 0;        ///< in one triangle
  std::int64_t crowded_edges = 0;       ///< in more than two triangles
  std::int64_t disoriented_edges = 0;   ///< in two triangles that run along it in the same direction
  std::int64_t pinched_vertices = 0;    ///< whose triangles make more than one fan
  std::int64_t repeated_positions = 0;  ///< vertices at the position of an earlier one
  std::int64_t off_lattice = 0;         ///< positions that are no multiple of 1/64

  std::int64_t euler() const { return vertices - edges + triangles; }
  bool is_manifold() const {
    return bad_indices + unused_vertices + crowded_edges + disoriented_edges + pinched_vertices == 0;
  }
  bool is_closed_manifold() const { return is_manifold() && border_edges == 0; }
};
std::ostream& operator<<(std::ostream& out, const MeshCensus& census);

/// cost     O(n log n); bad_indices > 0 leaves the other counts at what the sound triangles give.
MeshCensus census(const IndexedMesh& mesh);

/// The mesh with vertices of equal position made one; triangles keep their order.
IndexedMesh welded(const IndexedMesh& mesh);

}  // namespace geosis::test
