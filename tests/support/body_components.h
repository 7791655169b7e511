#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "tests/support/cell_topology.h"
#include "tests/support/grid_strata.h"
#include "tests/support/union_find.h"

namespace geosis::test {

/// Joins the bands of neighbouring cells: each band on a shared face meets an edge of that face.
class BandComponents {
 public:
  explicit BandComponents(GridShape cells) : cells_(cells) {
    for (auto& slab : slabs_) slab.resize(static_cast<std::size_t>(cells.crosslines) * cells.samples);
  }

  // Cells come in ascending order, all of them.
  void add(GridIndex cell, const std::array<std::int8_t, 12>& band_of_edge, int bands) {
    const std::int32_t first = next_;
    for (; next_ < first + bands; ++next_) components_.add();
    Edges& edges = at(cell);
    for (int e = 0; e < 12; ++e) edges[e] = band_of_edge[e] < 0 ? -1 : first + band_of_edge[e];
    for (int axis = 0; axis < 3; ++axis)
      if (cell[axis] > 0) join(edges, neighbour_before(cell, axis), axis);
  }
  void add_dropped(GridIndex cell) { at(cell).fill(-1); }
  std::int64_t count() const { return components_.count(); }

 private:
  using Edges = std::array<std::int32_t, 12>;

  Edges& at(GridIndex cell) { return slabs_[cell.i % 2][static_cast<std::size_t>(cell.j) * cells_.samples + cell.k]; }
  const Edges& neighbour_before(GridIndex cell, int axis) {
    cell[axis] -= 1;
    return at(cell);
  }
  void join(const Edges& edges, const Edges& before, int axis) {
    for (int d = 0; d < 3; ++d) {
      if (d == axis) continue;
      const bool axis_is_p = axis == (d == 0 ? 1 : 0);  // which of the edge's two offsets lies along the axis
      for (int other = 0; other < 2; ++other) {
        const int here = axis_is_p ? cell_edge(d, 0, other) : cell_edge(d, other, 0);
        const int there = axis_is_p ? cell_edge(d, 1, other) : cell_edge(d, other, 1);
        if (edges[here] >= 0 && before[there] >= 0) components_.unite(edges[here], before[there]);
      }
    }
  }

  GridShape cells_;
  std::array<std::vector<Edges>, 2> slabs_;  // the current layer of cells and the one before
  UnionFind components_;
  std::int32_t next_ = 0;
};

/// The closed rest of space: dropped cells, what lies beyond the grid, and the two sets outside the range. Each piece
/// of such a set contains a node outside the range. Dropped cells that share only a node of the body do not touch here:
/// the surface has a vertex for each (see voids_apart).
class RestComponents {
 public:
  explicit RestComponents(GridShape nodes)
      : nodes_(nodes), components_(2 * nodes.count() + 1), is_rest_(static_cast<std::size_t>(2 * nodes.count() + 1)) {
    is_rest_.back() = true;
  }

  void add_cell(GridIndex cell, const std::array<std::int8_t, 8>& rest_of_corner) {
    for (int c = 0; c < 8; ++c) {
      if (rest_of_corner[c] < 0) continue;
      int first = 0;
      while (rest_of_corner[first] != rest_of_corner[c]) ++first;
      unite(node(cell + unit_corner(c)), node(cell + unit_corner(first)));
    }
    for (int c = 0; c < 8; ++c)
      if (rest_of_corner[c] >= 0 && on_border(cell + unit_corner(c))) unite(node(cell + unit_corner(c)), beyond());
  }

  template <class IsInside>
  void add_dropped(const Domain& domain, GridIndex cell, IsInside&& is_inside) {
    for (int c = 0; c < 8; ++c) {
      const GridIndex corner = cell + unit_corner(c);
      if (!is_inside(corner)) unite(dropped(cell), node(corner));
      if (on_border(corner)) unite(dropped(cell), beyond());
    }
    for_each_node({3, 3, 3}, [&](GridIndex step) {
      const GridIndex other = cell + step - GridIndex{1, 1, 1};
      const int axes = (step.i != 1) + (step.j != 1) + (step.k != 1);
      if (axes <= 2 && domain.in_grid(other) && !domain.has(other)) unite(dropped(cell), dropped(other));
    });
  }

  std::int64_t count() const {
    std::int64_t unused = 0;
    for (const bool rest : is_rest_) unused += !rest;
    return components_.count() - unused;
  }

 private:
  std::int32_t node(GridIndex n) const { return (n.i * nodes_.crosslines + n.j) * nodes_.samples + n.k; }
  std::int32_t dropped(GridIndex cell) const { return static_cast<std::int32_t>(nodes_.count()) + node(cell); }
  std::int32_t beyond() const { return static_cast<std::int32_t>(2 * nodes_.count()); }
  bool on_border(GridIndex n) const {
    bool border = false;
    for (int axis = 0; axis < 3; ++axis) border = border || n[axis] == 0 || n[axis] == nodes_[axis] - 1;
    return border;
  }
  void unite(std::int32_t a, std::int32_t b) {
    is_rest_[a] = is_rest_[b] = true;
    components_.unite(a, b);
  }

  GridShape nodes_;
  UnionFind components_;  // nodes, cells (numbered by their first node), and what lies beyond
  std::vector<bool> is_rest_;
};

}  // namespace geosis::test
