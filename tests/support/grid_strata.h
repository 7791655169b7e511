#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "engine/volume/grid.h"
#include "tests/support/scalar_field.h"
#include "tests/support/union_find.h"

/// The grid as a cell complex: which of its open nodes, edges, faces and cells belong to the domain.
namespace geosis::test {

inline GridIndex operator+(GridIndex a, GridIndex b) {
  return {a.i + b.i, a.j + b.j, a.k + b.k};
}
inline GridIndex operator-(GridIndex a, GridIndex b) {
  return {a.i - b.i, a.j - b.j, a.k - b.k};
}

/// A corner of the unit cube from its number a * 4 + b * 2 + c.
constexpr GridIndex unit_corner(int corner) {
  return {corner >> 2 & 1, corner >> 1 & 1, corner & 1};
}

/// The cells without a missing corner.
class Domain {
 public:
  explicit Domain(const ScalarField& field)
      : cells_{field.shape.inlines - 1, field.shape.crosslines - 1, field.shape.samples - 1},
        present_(static_cast<std::size_t>(cells_.count()), 1) {
    for_each_node(field.shape, [&](GridIndex n) {
      if (!std::isnan(field.at(n))) return;
      for (int c = 0; c < 8; ++c)
        if (const GridIndex cell = n - unit_corner(c); in_grid(cell)) present_[index(cell)] = 0;
    });
  }

  GridShape cells() const { return cells_; }
  bool in_grid(GridIndex c) const {
    return c.i >= 0 && c.j >= 0 && c.k >= 0 && c.i < cells_.inlines && c.j < cells_.crosslines && c.k < cells_.samples;
  }
  bool has(GridIndex cell) const { return in_grid(cell) && present_[index(cell)] != 0; }

 private:
  std::size_t index(GridIndex c) const {
    return (static_cast<std::size_t>(c.i) * cells_.crosslines + c.j) * cells_.samples + c.k;
  }

  GridShape cells_;
  std::vector<std::uint8_t> present_;
};

/// An open node, edge, face or cell of the grid: the node it starts from and the axes it extends along, as a corner of
/// the unit cube.
struct Stratum {
  GridIndex first;
  int axes;

  int dimension() const { return (axes >> 2 & 1) + (axes >> 1 & 1) + (axes & 1); }
  int sign() const { return dimension() % 2 == 0 ? 1 : -1; }

  template <class Visit>
  void for_each_corner(Visit&& visit) const {
    for (int c = 0; c < 8; ++c)
      if ((c & ~axes) == 0) visit(first + unit_corner(c));
  }
  template <class Visit>
  void for_each_cell(Visit&& visit) const {
    for (int c = 0; c < 8; ++c)
      if ((c & axes) == 0) visit(first - unit_corner(c));
  }
};

template <class Visit>
void for_each_stratum(GridShape nodes, Visit&& visit) {
  for_each_node(nodes, [&](GridIndex n) {
    for (int axes = 0; axes < 8; ++axes) {
      const GridIndex last = n + unit_corner(axes);
      if (last.i < nodes.inlines && last.j < nodes.crosslines && last.k < nodes.samples) visit(Stratum{n, axes});
    }
  });
}

inline bool is_interior(const Domain& domain, const Stratum& stratum) {
  bool interior = true;
  stratum.for_each_cell([&](GridIndex cell) { interior = interior && domain.has(cell); });
  return interior;
}

/// Pieces the cells around a stratum fall into, two cells being joined when they share a face.
inline int pieces_around(const Domain& domain, const Stratum& stratum) {
  UnionFind cells(8);
  int present = 0, joins = 0;
  for (int c = 0; c < 8; ++c) {
    if ((c & stratum.axes) != 0 || !domain.has(stratum.first - unit_corner(c))) continue;
    ++present;
    for (int axis = 1; axis < 8; axis *= 2)
      if ((c & axis) != 0 && domain.has(stratum.first - unit_corner(c & ~axis)) &&
          cells.find(c) != cells.find(c & ~axis)) {
        cells.unite(c, c & ~axis);
        ++joins;
      }
  }
  return present - joins;
}

}  // namespace geosis::test
