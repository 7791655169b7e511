#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "engine/base/disjoint_sets.h"
#include "engine/isosurface/brick_field.h"
#include "engine/isosurface/brick_mesh.h"
#include "engine/isosurface/labelled_surface.h"
#include "engine/isosurface/node_runs.h"

namespace geosis {

/// Samples of a piece of the solid.
struct SampleTally {
  std::int64_t voxels = 0;
  double sum = 0;
  float min = std::numeric_limits<float>::infinity(), max = -std::numeric_limits<float>::infinity();

  void add(const SampleTally& other);
};

/// What a brick knows of one layer of nodes that it shares with a neighbour. Both have the same vertices there, in the
/// same order, and the same nodes; each has pieces of its own for them.
struct SharedLayer {
  /// Runs of nodes along the layer's last axis, piece by piece: run n of the row belongs to piece[first + n].
  struct Row {
    std::uint64_t nodes = 0, starts = 0;
    std::int32_t first = 0;
    std::int32_t run(int n) const { return first + std::popcount(starts & (~std::uint64_t{0} >> (63 - n))) - 1; }
  };
  std::vector<std::int32_t> of_vertex;   ///< pieces, as BrickMesh::lower_layer and upper_layer list the vertices
  std::vector<Row> rows;                 ///< by the layer's first axis
  std::vector<std::int32_t> piece;       ///< of runs
  std::vector<std::int32_t> of_contact;  ///< where the domain touches itself: each node's, group by group
};

/// The part of the solid in one brick, in connected pieces.
///
/// A piece is what is joined inside the brick; which pieces are one body is known when all bricks are.
struct BrickBodies {
  std::int32_t pieces = 0;
  bool is_whole = false;                    ///< all nodes of the brick are one piece; no layers are listed
  std::vector<std::int32_t> of_own_vertex;  ///< the vertices that weld_bricks takes from this brick, in order
  std::vector<SampleTally> samples;         ///< [piece], of the nodes that no next brick of the region has
  std::vector<std::uint64_t> six_volumes;   ///< [piece], see lattice_volumes; empty without cap
  std::array<std::array<SharedLayer, 2>, 3> layers{};  ///< [axis][lower, upper]; empty where nothing is shared
};

/// Finds the pieces of brick after brick with one set of buffers. One object a thread.
///
/// Inside a closed cell the border of each component of the body is connected, and made of pieces of the sheets and
/// of faces; around a piece of a face, sheets and stretches of edges alternate. So the components are known from the
/// edges alone: vertices of a triangle are joined, a crossing to the node at its edge's inner end, two crossings of an
/// edge whose ends are outside, and two nodes whose edge is inside. Cells that share no face are not joined, as in the
/// mesh (contacts.h).
class BrickLabeller {
 public:
  /// field   of the mesher that made the meshes.
  /// labels  kept by reference; its seeds are not looked at.
  BrickLabeller(const BrickField& field, const ExtractOptions& options, const LabelOptions& labels);

  /// mesh    of the brick that the field holds.
  /// cost    near enough O(vertices + triangles + runs of nodes in range).
  BrickBodies label(const BrickMesh& mesh);
  /// The same for a brick all of whose nodes are in range, that misses no sample nearby.
  /// errors  malformed_input: damaged brick; it is read only for amplitudes.
  Result<BrickBodies> label_whole(const BrickedVolume& volume, std::size_t brick, const GridBox& region) const;

  /// Piece of the node (of the brick labelled last); kNone outside the solid.
  static constexpr std::int32_t kNone = -1;
  std::int32_t piece_of(GridIndex node) const;

 private:
  std::int32_t join_place(const BrickMesh& mesh, std::int32_t vertex);
  std::int32_t join_node_copies(std::int32_t vertex, int a, int b, int c);
  std::int32_t join_edge_vertices(std::int32_t vertex, int axis, int a, int b, int c);
  SharedLayer layer_of(const BrickMesh& mesh, int axis, bool upper) const;
  void add_layer_node(SharedLayer& layer, SharedLayer::Row& row, GridIndex node, int n, bool may_start) const;
  void tally_row(int a, int b, std::vector<SampleTally>& samples) const;
  std::uint64_t counted(GridIndex node, int count) const;

  const BrickField& field_;
  const bool capped_, mirrored_, amplitudes_;
  const LabelOptions& labels_;
  NodeRuns runs_;
  DisjointSets sets_;                ///< vertices, then runs
  std::vector<std::int32_t> piece_;  ///< element -> piece
};

/// Signed volume that the triangles of each piece enclose, times 6 * 64^3, modulo 2^64.
///
/// It is summed from the projections along the sample axis in lattice steps: pieces of a closed surface may be summed
/// in any order and the total is exact, as long as a body has less than 2^42 voxels.
std::vector<std::uint64_t> lattice_volumes(const BrickMesh& mesh, std::span<const std::int32_t> of_vertex,
                                           std::int32_t pieces, bool mirrored);

}  // namespace geosis
