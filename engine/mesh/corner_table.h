#pragma once

#include <cstdint>
#include <vector>

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/mesh/indexed_mesh.h"

namespace geosis {

/// Connectivity of an oriented triangle mesh as two arrays of integers.
///
///         p            Triangle t owns the corners 3t, 3t + 1, 3t + 2, in the order of its vertices.
///       / | \          Corner c sits at vertex[c] and faces the edge n -> p, where n = next(c), p = previous(c).
///     c   |   o        Across that edge lies o = opposite[c], and opposite[o] = c.
///       \ | /          On a boundary there is nothing across: opposite[c] = kNoCorner.
///         n
struct CornerTable {
  static constexpr std::int32_t kNoCorner = -1;

  std::vector<std::int32_t> vertex;    ///< V: (3m) corner -> vertex
  std::vector<std::int32_t> opposite;  ///< O: (3m) corner -> corner across the facing edge

  static constexpr std::int32_t triangle(std::int32_t c) { return c / 3; }
  static constexpr std::int32_t next(std::int32_t c) { return c % 3 == 2 ? c - 2 : c + 1; }
  static constexpr std::int32_t previous(std::int32_t c) { return c % 3 == 0 ? c + 2 : c - 1; }

  std::int32_t corners() const { return static_cast<std::int32_t>(vertex.size()); }

  /// The next corner at the same vertex, counter-clockwise seen from outside; kNoCorner past a boundary edge.
  std::int32_t swing(std::int32_t c) const {
    const std::int32_t across = opposite[next(c)];
    return across == kNoCorner ? kNoCorner : next(across);
  }

  /// For a corner that faces a boundary edge a -> b: the corner that faces the boundary edge b -> ...
  std::int32_t next_on_boundary(std::int32_t c) const {
    c = next(c);
    while (opposite[c] != kNoCorner) c = next(opposite[c]);
    return c;
  }
};

/// Finds for each corner the one across its edge, by sorting the edges.
///
/// errors   invalid_argument: a vertex index out of range, a triangle with a repeated vertex, an edge in more than two
///          triangles, an edge that both its triangles run along in the same direction; the message says where.
///          limit_exceeded: more corners than 32-bit indices can name.  cancelled.
/// cost     O(triangles log valence), no hash map; 24 bytes a triangle while it runs.
/// source   Rossignac, Safonova & Szymczak 2001 (the V and O tables).
Result<CornerTable> build_corner_table(const IndexedMesh& mesh, const Progress& progress = NoProgress());

}  // namespace geosis
