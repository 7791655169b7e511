#include "tests/support/body_oracle.h"

#include <array>
#include <cmath>
#include <vector>

#include "tests/support/cell_topology.h"
#include "tests/support/union_find.h"

namespace geosis::test {
namespace {

GridIndex operator+(GridIndex a, GridIndex b) {
  return {a.i + b.i, a.j + b.j, a.k + b.k};
}
GridIndex operator-(GridIndex a, GridIndex b) {
  return {a.i - b.i, a.j - b.j, a.k - b.k};
}

// A corner of the unit cube from its number a * 4 + b * 2 + c.
constexpr GridIndex unit_corner(int corner) {
  return {corner >> 2 & 1, corner >> 1 & 1, corner & 1};
}

// The cells without a missing corner.
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

// What a sample is to the range.
class Classifier {
 public:
  Classifier(IsoRange range, BodyMode mode) : low_(range.low), high_(range.high), mode_(mode) {}

  Side side(float f) const { return f < low_ ? Side::below : f > high_ ? Side::above : Side::inside; }

  CornerValue corner(float f) const {
    if (mode_ == BodyMode::exact)
      return {side(f), {static_cast<long double>(low_) - f, f - static_cast<long double>(high_)}};
    // One function g with the body at g >= 0: whatever is outside is below.
    const double rise = static_cast<double>(f) - low_, fall = static_cast<double>(high_) - f;
    const double g = std::isinf(high_) ? rise : std::isinf(low_) ? fall : rise * fall;
    return {side(f) == Side::inside ? Side::inside : Side::below, {-g, g}};
  }

 private:
  float low_, high_;
  BodyMode mode_;
};

// Every sample is below or above: what lies between is the surface {f = level} alone.
class LevelClassifier {
 public:
  LevelClassifier(double level, bool level_is_above) : level_(level), level_is_above_(level_is_above) {}

  CornerValue corner(double f) const {
    const bool above = level_is_above_ ? f >= level_ : f > level_;
    return {above ? Side::above : Side::below,
            {static_cast<long double>(level_) - f, f - static_cast<long double>(level_)}};
  }

 private:
  double level_;
  bool level_is_above_;
};

// An open node, edge, face or cell of the grid: the node it starts from and the axes it extends along, as a corner of
// the unit cube.
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

bool is_interior(const Domain& domain, const Stratum& stratum) {
  bool interior = true;
  stratum.for_each_cell([&](GridIndex cell) { interior = interior && domain.has(cell); });
  return interior;
}

// Pieces the cells around a stratum fall into, two cells being joined when they share a face.
int pieces_around(const Domain& domain, const Stratum& stratum) {
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

struct StratumEuler {
  std::array<int, kOutsides> outside{};  // chi_c of each set in the open stratum
  bool decided = true;
};

// The corners of a stratum in ascending order, as many as it has.
template <class Values>
std::array<CornerValue, 8> corners_of(const ScalarField& field, const Values& values, const Stratum& stratum) {
  std::array<CornerValue, 8> corners;
  std::size_t count = 0;
  stratum.for_each_corner([&](GridIndex n) { corners[count++] = values.corner(field.at(n)); });
  return corners;
}

StratumEuler stratum_euler(const std::array<CornerValue, 8>& corners, int dimension) {
  StratumEuler euler;
  if (dimension == 3) {
    const CellTopology topology = cell_topology(corners);
    return {topology.open_euler, topology.decided};
  }
  for (int o = 0; o < kOutsides; ++o) {
    if (dimension == 0) euler.outside[o] = corners[0].in(o);
    if (dimension == 1) euler.outside[o] = corners[0].in(o) && corners[1].in(o) ? -1 : 0;
    if (dimension == 2) {
      const SquareDecision decision = decide_square({corners[0], corners[1], corners[3], corners[2]}, o);
      euler.outside[o] = open_square_euler(decision.pattern);
      euler.decided = euler.decided && !decision.tied;
    }
  }
  return euler;
}

// Visits each stratum that meets the domain with chi_c of what lies in neither set.
template <class Values, class Visit>
bool for_each_euler(const ScalarField& field, const Domain& domain, const Values& values, Visit&& visit) {
  bool decided = true;
  for_each_stratum(field.shape, [&](const Stratum& stratum) {
    bool meets = false;
    stratum.for_each_cell([&](GridIndex cell) { meets = meets || domain.has(cell); });
    if (!meets) return;
    const auto corners = corners_of(field, values, stratum);
    const int count = 1 << stratum.dimension();
    bool uniform = true;
    for (int c = 1; c < count; ++c) uniform = uniform && corners[c].side == corners[0].side;
    if (uniform) {
      visit(stratum, corners[0].side == Side::inside ? stratum.sign() : 0);
      return;
    }
    const StratumEuler euler = stratum_euler(corners, stratum.dimension());
    decided = decided && euler.decided;
    visit(stratum, stratum.sign() - euler.outside[kBelow] - euler.outside[kAbove]);
  });
  return decided;
}

// Joins the bands of neighbouring cells: each band on a shared face meets an edge of that face.
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

// The closed rest of space: dropped cells, what lies beyond the grid, and the two sets outside the range. Each piece of
// such a set contains a node outside the range. Dropped cells that share only a node of the body do not touch here: the
// surface has a vertex for each (see voids_apart).
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

// Topology of a cell whose corners lie all on one side.
CellTopology uniform_cell(bool has_body) {
  CellTopology topology;
  topology.band_of_edge.fill(has_body ? 0 : -1);
  topology.rest_of_corner.fill(has_body ? -1 : 0);
  topology.bands = has_body ? 1 : 0;
  return topology;
}

CellTopology topology_of(const ScalarField& field, const Classifier& values, GridIndex cell) {
  const auto corners = corners_of(field, values, Stratum{cell, 7});
  for (const CornerValue& corner : corners)
    if (corner.side != corners[0].side) return cell_topology(corners);
  return uniform_cell(corners[0].side == Side::inside);
}

std::int64_t surface_components(const ScalarField& field, const Domain& domain, const Classifier& values) {
  BandComponents body(domain.cells());
  RestComponents rest(field.shape);
  const auto is_inside = [&](GridIndex n) { return values.side(field.at(n)) == Side::inside; };
  for_each_node(domain.cells(), [&](GridIndex cell) {
    if (domain.has(cell)) {
      const CellTopology topology = topology_of(field, values, cell);
      body.add(cell, topology.band_of_edge, topology.bands);
      rest.add_cell(cell, topology.rest_of_corner);
    } else {
      body.add_dropped(cell);
      rest.add_dropped(domain, cell, is_inside);
    }
  });
  return body.count() + rest.count() - 1;
}

// Around a node of the body on the domain's border the body is a cone over some region R of a small sphere. The
// 3-manifold has one disc there if R is a disc; but if R has b > 1 rims (dropped cells that meet in the node alone),
// its border would be a tube of no width, for which the surface has b discs. Returns the sum of b - 1 over the pieces
// of R.
int voids_apart(const Domain& domain, GridIndex node) {
  int euler = 0;
  for (int axes = 1; axes < 8; ++axes)
    for (int side = 0; side < 8; ++side) {
      if ((side & axes) != side) continue;  // `side` picks the stratum's direction along each of its axes
      const Stratum stratum{node - unit_corner(side), axes};
      if (is_interior(domain, stratum)) euler -= stratum.sign();
    }
  return pieces_around(domain, {node, 0}) - euler;
}

// The sampled mode's g has one level, zero: inside is above it.
class SampledLevel {
 public:
  explicit SampledLevel(IsoRange range) : body_(range, BodyMode::sampled) {}

  CornerValue corner(float f) const {
    CornerValue value = body_.corner(f);
    if (value.side == Side::inside) value.side = Side::above;
    return value;
  }

 private:
  Classifier body_;
};

// chi_c of {f = level}, once for each piece of the domain around a stratum: a rim that only touches itself is split.
template <class Values>
SurfaceTopology level_set(const ScalarField& field, const Domain& domain, const Values& values) {
  SurfaceTopology surface;
  surface.decided = for_each_euler(field, domain, values, [&](const Stratum& stratum, int between) {
    // The sets count without their common border, which is therefore counted twice with the wrong sign.
    if (between != 0) surface.euler -= between * pieces_around(domain, stratum);
  });
  return surface;
}

}  // namespace

SurfaceTopology expected_surface(const ScalarField& field, IsoRange range, BodyMode mode) {
  const Domain domain(field);
  const Classifier values(range, mode);
  std::int64_t open_body = 0, tubes = 0;
  SurfaceTopology surface;
  surface.decided = for_each_euler(field, domain, values, [&](const Stratum& stratum, int body) {
    if (body == 0) return;
    if (is_interior(domain, stratum))
      open_body += body;
    else if (stratum.dimension() == 0)
      tubes += voids_apart(domain, stratum.first);
  });
  surface.euler = 2 * (tubes - open_body);
  surface.components = surface_components(field, domain, values);
  return surface;
}

SurfaceTopology expected_open_surface(const ScalarField& field, IsoRange range, BodyMode mode) {
  const Domain domain(field);
  if (mode == BodyMode::sampled) return level_set(field, domain, SampledLevel(range));
  SurfaceTopology surface;
  for (const bool at_low : {true, false}) {
    const float level = at_low ? range.low : range.high;
    if (std::isinf(level)) continue;
    const SurfaceTopology sheet = level_set(field, domain, LevelClassifier(level, at_low));
    surface.decided = surface.decided && sheet.decided;
    surface.euler += sheet.euler;
  }
  return surface;
}

}  // namespace geosis::test
