#pragma once

#include <bit>
#include <cstdint>
#include <vector>

#include "engine/base/disjoint_sets.h"
#include "engine/isosurface/brick_field.h"
#include "engine/isosurface/cell.h"

namespace geosis {

/// The nodes of one brick that lie in the body, as elements of the solid: runs of nodes along the sample axis that
/// the edges between them join. A node where the domain only touches itself is one element for each piece of it.
///
/// A node without a present cell around it is no part of the solid.
class NodeRuns {
 public:
  explicit NodeRuns(const BrickField& field);

  /// Finds those of the loaded brick and numbers them first, first + 1, ...
  void find(std::int32_t first);
  std::int32_t count() const { return next_ - first_; }

  /// Unites what an edge inside the body joins.
  void join(DisjointSets& sets) const;

  /// Nodes of a row that are in the solid, as bits; among them, those where the domain touches itself.
  std::uint64_t nodes(int a, int b) const { return row(a, b).plain | row(a, b).contacts; }
  std::uint64_t contacts(int a, int b) const { return row(a, b).contacts; }
  /// Nodes of a row where a run begins.
  std::uint64_t starts(int a, int b) const { return row(a, b).starts; }

  /// Element of a node in the solid as the cell in that octant around it sees it.
  std::int32_t element(int a, int b, int c, int octant) const;
  /// The same where it does not matter: the first, of a node where the domain touches itself.
  std::int32_t element(int a, int b, int c) const;

 private:
  struct Row {
    std::uint64_t plain = 0, starts = 0, contacts = 0;
    std::int32_t first_run = 0;
    std::int32_t first_contact = 0;  ///< place in contact_element_
  };
  static std::size_t at(int a, int b) { return static_cast<std::size_t>(a) * kBrickSamples + b; }
  const Row& row(int a, int b) const { return rows_[at(a, b)]; }
  static std::uint64_t up_to(int c) { return ~std::uint64_t{0} >> (63 - c); }
  static std::int32_t run(const Row& row, int c) { return row.first_run + std::popcount(row.starts & up_to(c)) - 1; }

  void find_row(int a, int b);
  std::uint64_t present_edges(int axis, int a, int b) const;
  void join_row(int a, int b, DisjointSets& sets) const;
  void join_rows(int axis, int a, int b, DisjointSets& sets) const;
  void join_edge(int axis, int a, int b, int c, DisjointSets& sets) const;

  const BrickField& field_;
  std::int32_t first_ = 0, next_ = 0;
  std::vector<Row> rows_;
  std::vector<std::int32_t> contact_element_;  ///< first element of each node where the domain touches itself
};

/// Octants, around the start and the end of an edge along `axis`, of the cell at `place` around the edge.
constexpr int octant_at_start(int axis, int place) {
  return ((place & 2) != 0 ? cell::corner_bit(cell::first_axis(axis)) : 0) +
         ((place & 1) != 0 ? cell::corner_bit(cell::second_axis(axis)) : 0) + cell::corner_bit(axis);
}
constexpr int octant_at_end(int axis, int place) {
  return octant_at_start(axis, place) - cell::corner_bit(axis);
}

}  // namespace geosis
