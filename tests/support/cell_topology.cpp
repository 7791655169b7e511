#include "tests/support/cell_topology.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <vector>

#include <gmpxx.h>

#include "tests/support/union_find.h"

// A cell is swept by squares of constant k = t, 0 <= t <= 1. On each square f is bilinear, and what matters of it is
// known from the sides of its four corners and, for two opposite corners, from the sign of AC - BD. Both change at
// finitely many t only. So the cell falls into slices (the squares at 0, 1 and at each change) and the open slabs
// between them, over which the pattern is constant:
//   - Euler characteristics with compact supports add up over these pieces, a slab counting -1 times its square;
//   - components are those of the pieces, joined where a slice touches a slab.
// Both sets outside the range are closed, so at the change itself a corner counts as in, a diagonal as joined.
// No derivative and no critical point of f is needed, and samples that are equal are no special case.

namespace geosis::test {
namespace {

// Whether the sign of a determinant of terms of this size is not to be trusted.
bool is_tie(long double determinant, long double size) {
  constexpr long double kTie = 1e4L * std::numeric_limits<long double>::epsilon();
  return std::abs(determinant) <= kTie * size;
}
bool is_tie(const mpq_class& determinant, const mpq_class&) {
  return determinant == 0;
}

// Corners of the square at t = 0 in cyclic order as corners of the cell; the square at t = 1 has the next numbers.
constexpr std::array<int, 4> kBottom = {0, 4, 6, 2};
// Side s of a square joins its corners s and s + 1; as edges of the cell at t = 0, and (next number) at t = 1.
constexpr std::array<int, 4> kBottomEdge = {cell_edge(0, 0, 0), cell_edge(1, 1, 0), cell_edge(0, 1, 0),
                                            cell_edge(1, 0, 0)};
constexpr std::array<int, 4> kUprightEdge = {cell_edge(2, 0, 0), cell_edge(2, 1, 0), cell_edge(2, 1, 1),
                                             cell_edge(2, 0, 1)};

enum class Kind { leave, enter, join, part };

template <class Number>
struct Change {
  Number t;
  Kind kind;
  int outside;
  int corner;  // of the square; unused by join and part
};

// Leaving comes before entering, so that no corner is ever on both sides of the range.
template <class Number>
bool comes_before(const Change<Number>& a, const Change<Number>& b) {
  return a.t < b.t || (a.t == b.t && a.kind == Kind::leave && b.kind != Kind::leave);
}

struct Piece {
  bool is_slice;
  std::array<SquarePattern, kOutsides> outside;

  bool corner_inside(int c) const { return !outside[kBelow].in[c] && !outside[kAbove].in[c]; }
  bool band_on_side(int s) const {
    const int next = (s + 1) % 4;
    return !(outside[kBelow].in[s] && outside[kBelow].in[next]) && !(outside[kAbove].in[s] && outside[kAbove].in[next]);
  }
};

template <class Number>
SquareCorners<Number> square_at(const CellCorners<Number>& cell, int t) {
  SquareCorners<Number> square;
  for (int c = 0; c < 4; ++c) square[c] = cell[kBottom[c] + t];
  return square;
}

// The two upright edges of one corner of the square, as a linear function of t.
template <class Number>
struct Upright {
  Number bottom, top;
  Number at(const Number& t) const { return bottom + (top - bottom) * t; }
  Number slope() const { return top - bottom; }
  Number size() const { return std::max<Number>(abs(bottom), abs(top)); }

 private:
  static Number abs(const Number& x) { return x < 0 ? Number(-x) : x; }
};

template <class Number>
Upright<Number> upright(const CellCorners<Number>& cell, int outside, int c) {
  return {cell[kBottom[c % 4]].excess[outside], cell[kBottom[c % 4] + 1].excess[outside]};
}

template <class Number>
std::vector<Change<Number>> corner_changes(const CellCorners<Number>& cell, int outside) {
  std::vector<Change<Number>> changes;
  for (int c = 0; c < 4; ++c) {
    const bool starts_in = cell[kBottom[c]].in(outside);
    if (starts_in == cell[kBottom[c] + 1].in(outside)) continue;
    const Upright<Number> e = upright(cell, outside, c);
    changes.push_back({Number(e.bottom / (e.bottom - e.top)), starts_in ? Kind::leave : Kind::enter, outside, c});
  }
  std::sort(changes.begin(), changes.end(), comes_before<Number>);
  return changes;
}

// Where corners c and c + 2 are in the set over the whole slab (from, to) and start and end equally joined, the saddle
// may still cross the end of the range twice in between. True if so; `at` is the extremum of AC - BD.
template <class Number>
bool saddle_crosses_twice(const CellCorners<Number>& cell, int outside, int c, const Change<Number>& from,
                          const Change<Number>& to, bool joined, Number& at, bool& decided) {
  const Upright<Number> A = upright(cell, outside, c), B = upright(cell, outside, c + 1);
  const Upright<Number> C = upright(cell, outside, c + 2), D = upright(cell, outside, c + 3);
  const Number quadratic = A.slope() * C.slope() - B.slope() * D.slope();
  const Number linear = A.slope() * C.bottom + A.bottom * C.slope() - B.slope() * D.bottom - B.bottom * D.slope();
  if (quadratic == 0) return false;
  at = -linear / (2 * quadratic);
  if (!(from.t < at && at < to.t)) return false;
  const Number extremum = A.at(at) * C.at(at) - B.at(at) * D.at(at);
  if (is_tie(extremum, Number(A.size() * C.size() + B.size() * D.size()))) decided = false;
  return joined != (extremum >= 0);
}

// All changes of one set in their order: corners, and the diagonal's joins and parts. Next to a corner's change the
// sign of AC - BD is that of one product, so neither needs a computed root; a root's place within its slab is free.
template <class Number>
std::vector<Change<Number>> changes_of(const CellCorners<Number>& cell, int outside, const SquarePattern& bottom,
                                       bool top_joined, bool& decided) {
  std::vector<Change<Number>> corners = corner_changes(cell, outside);
  corners.push_back({Number(1), top_joined ? Kind::enter : Kind::leave, outside, -1});  // the top square, as a sentinel
  std::vector<Change<Number>> all;
  SquarePattern pattern = bottom;
  Change<Number> from{Number(0), bottom.joined ? Kind::leave : Kind::enter, outside, -1};
  for (const Change<Number>& to : corners) {
    const bool joined = from.kind == Kind::leave, ends_joined = to.kind == Kind::enter;
    Number at = 0;
    if (pattern.is_diagonal() && joined != ends_joined) {
      all.push_back({Number((from.t + to.t) / 2), joined ? Kind::part : Kind::join, outside, -1});
    } else if (pattern.is_diagonal() &&
               saddle_crosses_twice(cell, outside, pattern.in[0] ? 0 : 1, from, to, joined, at, decided)) {
      all.push_back({at, joined ? Kind::part : Kind::join, outside, -1});
      all.push_back({at, joined ? Kind::join : Kind::part, outside, -1});
    }
    if (to.corner < 0) break;
    all.push_back(to);
    pattern.in[to.corner] = to.kind == Kind::enter;
    from = to;
  }
  return all;
}

template <class Number>
std::vector<Change<Number>> merged(const std::vector<Change<Number>>& a, const std::vector<Change<Number>>& b) {
  std::vector<Change<Number>> all;
  std::size_t i = 0, j = 0;
  while (i < a.size() || j < b.size()) {
    const bool take_a = j == b.size() || (i < a.size() && !comes_before(b[j], a[i]));
    all.push_back(take_a ? a[i++] : b[j++]);
  }
  return all;
}

template <class Number>
std::vector<Piece> pieces_of(const CellCorners<Number>& cell, bool& decided) {
  const SquareCorners<Number> bottom = square_at(cell, 0), top = square_at(cell, 1);
  Piece now{true, {}};
  std::array<std::vector<Change<Number>>, kOutsides> changes;
  for (int o = 0; o < kOutsides; ++o) {
    now.outside[o] = decide_square(bottom, o).pattern;
    changes[o] = changes_of(cell, o, now.outside[o], decide_square(top, o).pattern.joined, decided);
  }
  std::vector<Piece> pieces{now};
  for (const Change<Number>& change : merged(changes[kBelow], changes[kAbove])) {
    now.is_slice = false;
    pieces.push_back(now);
    SquarePattern& pattern = now.outside[change.outside];
    now.is_slice = true;
    if (change.kind == Kind::enter) pattern.in[change.corner] = true;
    if (change.kind == Kind::enter) pattern.joined = false;
    if (change.kind == Kind::join) pattern.joined = true;
    pieces.push_back(now);
    if (change.kind == Kind::leave) pattern.in[change.corner] = false;
    if (change.kind == Kind::leave) pattern.joined = true;
    if (change.kind == Kind::part) pattern.joined = false;
  }
  now.is_slice = false;
  pieces.push_back(now);
  now.is_slice = true;
  pieces.push_back(now);
  return pieces;
}

// Numbers the sets of a union-find 0, 1, 2, ... as they are first asked for.
class Labels {
 public:
  std::int8_t of(std::int32_t root) {
    return static_cast<std::int8_t>(labels_.try_emplace(root, static_cast<int>(labels_.size())).first->second);
  }
  int count() const { return static_cast<int>(labels_.size()); }

 private:
  std::map<std::int32_t, int> labels_;
};

// f is linear along a side of the square, so its band there is one interval: one place per piece and side. A component
// of the band in a square always meets a side, since a bilinear function has no closed level curve. Only a diagonal
// joined in one of the two sets cuts the square, into the two sides at B and the two sides at D.
void find_bands(const std::vector<Piece>& pieces, CellTopology& topology) {
  UnionFind places(static_cast<std::int64_t>(pieces.size()) * 4);
  const auto place = [](std::size_t piece, int side) { return static_cast<std::int32_t>(piece * 4 + side); };
  for (std::size_t p = 0; p < pieces.size(); ++p) {
    for (int s = 0; s < 4; ++s) {
      if (!pieces[p].band_on_side(s)) continue;
      if (p > 0 && pieces[p - 1].band_on_side(s)) places.unite(place(p, s), place(p - 1, s));
      for (int other = 0; other < s; ++other) {
        bool cut = false;
        for (const SquarePattern& pattern : pieces[p].outside)
          if (pattern.is_diagonal() && pattern.joined) {
            const int b = pattern.in[0] ? 1 : 0;  // sides b - 1 and b meet at the corner b
            const auto at_b = [b](int side) { return side == b || side == (b + 3) % 4; };
            cut |= at_b(s) != at_b(other);
          }
        if (!cut && pieces[p].band_on_side(other)) places.unite(place(p, s), place(p, other));
      }
    }
  }
  Labels labels;
  topology.band_of_edge.fill(-1);
  const auto label = [&](int edge, std::size_t piece, int side) {
    topology.band_of_edge[edge] = labels.of(places.find(place(piece, side)));
  };
  for (int s = 0; s < 4; ++s) {
    if (pieces.front().band_on_side(s)) label(kBottomEdge[s], 0, s);
    if (pieces.back().band_on_side(s)) label(kBottomEdge[s] + 1, pieces.size() - 1, s);
    const auto inside = std::find_if(pieces.begin(), pieces.end(), [s](const Piece& p) { return p.corner_inside(s); });
    if (inside != pieces.end()) label(kUprightEdge[s], static_cast<std::size_t>(inside - pieces.begin()), s);
  }
  topology.bands = labels.count();
}

// Every component of a set {bilinear > 0} contains a corner of its square: one place per piece and corner.
void find_rest(const std::vector<Piece>& pieces, CellTopology& topology) {
  UnionFind places(static_cast<std::int64_t>(pieces.size()) * 4);
  const auto place = [](std::size_t piece, int corner) { return static_cast<std::int32_t>(piece * 4 + corner); };
  for (std::size_t p = 0; p < pieces.size(); ++p)
    for (int o = 0; o < kOutsides; ++o) {
      const SquarePattern& pattern = pieces[p].outside[o];
      const bool connected = !pattern.is_diagonal() || pattern.joined;
      for (int c = 0; c < 4; ++c) {
        if (!pattern.in[c]) continue;
        if (p > 0 && pieces[p - 1].outside[o].in[c]) places.unite(place(p, c), place(p - 1, c));
        for (int other = 0; other < c; ++other)
          if (connected && pattern.in[other]) places.unite(place(p, c), place(p, other));
      }
    }
  Labels labels;
  for (int c = 0; c < 4; ++c)
    for (int t = 0; t < 2; ++t) {
      const std::size_t p = t == 0 ? 0 : pieces.size() - 1;
      topology.rest_of_corner[kBottom[c] + t] =
          pieces[p].corner_inside(c) ? std::int8_t{-1} : labels.of(places.find(place(p, c)));
    }
}

}  // namespace

template <class Number>
SquareDecision decide_square(const SquareCorners<Number>& corners, int outside) {
  SquareDecision decision;
  for (int c = 0; c < 4; ++c) decision.pattern.in[c] = corners[c].in(outside);
  if (!decision.pattern.is_diagonal()) return decision;
  const int c = decision.pattern.in[0] ? 0 : 1;
  const Number in_product = corners[c].excess[outside] * corners[c + 2].excess[outside];
  const Number out_product = corners[c + 1].excess[outside] * corners[(c + 3) % 4].excess[outside];
  decision.pattern.joined = in_product >= out_product;
  decision.tied = is_tie(Number(in_product - out_product), Number(in_product + out_product));
  return decision;
}

int open_square_euler(const SquarePattern& pattern) {
  const int corners = pattern.corners_in();
  const int closed = pattern.is_diagonal() && !pattern.joined ? 2 : corners > 0;
  int full_sides = 0;
  for (int s = 0; s < 4; ++s) full_sides += pattern.in[s] && pattern.in[(s + 1) % 4];
  return closed - corners + full_sides;
}

template <class Number>
CellTopology cell_topology(const CellCorners<Number>& corners) {
  CellTopology topology;
  const std::vector<Piece> pieces = pieces_of(corners, topology.decided);
  for (std::size_t p = 1; p + 1 < pieces.size(); ++p)
    for (int o = 0; o < kOutsides; ++o)
      topology.open_euler[o] += (pieces[p].is_slice ? 1 : -1) * open_square_euler(pieces[p].outside[o]);
  find_bands(pieces, topology);
  find_rest(pieces, topology);
  return topology;
}

template SquareDecision decide_square(const SquareCorners<long double>&, int);
template SquareDecision decide_square(const SquareCorners<mpq_class>&, int);
template CellTopology cell_topology(const CellCorners<long double>&);
template CellTopology cell_topology(const CellCorners<mpq_class>&);

}  // namespace geosis::test
