#include "tests/support/body_oracle.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <gmpxx.h>

#include "tests/support/body_components.h"
#include "tests/support/cell_topology.h"
#include "tests/support/grid_strata.h"
#include "tests/support/range_sides.h"

namespace geosis::test {
namespace {

template <class Sides>
bool is_uniform(const ScalarField& field, const Sides& sides, const Stratum& stratum) {
  const Side side = sides.side(field.at(stratum.first));
  bool uniform = true;
  stratum.for_each_corner([&](GridIndex n) { uniform = uniform && sides.side(field.at(n)) == side; });
  return uniform;
}

struct StratumEuler {
  std::array<int, kOutsides> outside{};  // chi_c of each set in the open stratum
  bool decided = true;
};

// The corners of a stratum in ascending order, as many as it has.
template <class Sides>
CellCorners<typename Sides::Number> corners_of(const ScalarField& field, const Sides& sides, const Stratum& stratum) {
  CellCorners<typename Sides::Number> corners;
  std::size_t count = 0;
  stratum.for_each_corner([&](GridIndex n) { corners[count++] = sides.corner(field.at(n)); });
  return corners;
}

template <class Number>
StratumEuler stratum_euler(const CellCorners<Number>& corners, int dimension) {
  StratumEuler euler;
  if (dimension == 3) {
    const CellTopology topology = cell_topology(corners);
    return {topology.open_euler, topology.decided};
  }
  for (int o = 0; o < kOutsides; ++o) {
    if (dimension == 0) euler.outside[o] = corners[0].in(o);
    if (dimension == 1) euler.outside[o] = corners[0].in(o) && corners[1].in(o) ? -1 : 0;
    if (dimension == 2) {
      const SquareDecision decision = decide_square<Number>({corners[0], corners[1], corners[3], corners[2]}, o);
      euler.outside[o] = open_square_euler(decision.pattern);
      euler.decided = euler.decided && !decision.tied;
    }
  }
  return euler;
}

// Visits each stratum that meets the domain with chi_c of what lies in neither set.
template <class Sides, class Visit>
bool for_each_euler(const ScalarField& field, const Domain& domain, const Sides& sides, Visit&& visit) {
  bool decided = true;
  for_each_stratum(field.shape, [&](const Stratum& stratum) {
    bool meets = false;
    stratum.for_each_cell([&](GridIndex cell) { meets = meets || domain.has(cell); });
    if (!meets) return;
    if (is_uniform(field, sides, stratum)) {
      visit(stratum, sides.side(field.at(stratum.first)) == Side::inside ? stratum.sign() : 0);
      return;
    }
    const StratumEuler euler = stratum_euler(corners_of(field, sides, stratum), stratum.dimension());
    decided = decided && euler.decided;
    visit(stratum, stratum.sign() - euler.outside[kBelow] - euler.outside[kAbove]);
  });
  return decided;
}

// Topology of a cell whose corners lie all on one side.
CellTopology uniform_cell(bool has_body) {
  CellTopology topology;
  topology.band_of_edge.fill(has_body ? 0 : -1);
  topology.rest_of_corner.fill(has_body ? -1 : 0);
  topology.bands = has_body ? 1 : 0;
  return topology;
}

template <class Number>
CellTopology topology_of(const ScalarField& field, const BodySides<Number>& sides, GridIndex cell) {
  const Stratum stratum{cell, 7};
  if (is_uniform(field, sides, stratum)) return uniform_cell(sides.side(field.at(cell)) == Side::inside);
  return cell_topology(corners_of(field, sides, stratum));
}

template <class Number>
std::int64_t surface_components(const ScalarField& field, const Domain& domain, const BodySides<Number>& sides) {
  BandComponents body(domain.cells());
  RestComponents rest(field.shape);
  const auto is_inside = [&](GridIndex n) { return sides.side(field.at(n)) == Side::inside; };
  for_each_node(domain.cells(), [&](GridIndex cell) {
    if (domain.has(cell)) {
      const CellTopology topology = topology_of(field, sides, cell);
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

// chi_c of {f = level}, once for each piece of the domain around a stratum: a rim that only touches itself is split.
template <class Sides>
SurfaceTopology level_set(const ScalarField& field, const Domain& domain, const Sides& sides) {
  SurfaceTopology surface;
  surface.decided = for_each_euler(field, domain, sides, [&](const Stratum& stratum, int between) {
    // The sets count without their common border, which is therefore counted twice with the wrong sign.
    if (between != 0) surface.euler -= between * pieces_around(domain, stratum);
  });
  return surface;
}

template <class Number>
SurfaceTopology closed_surface(const ScalarField& field, IsoRange range, BodyMode mode, const Number& apart) {
  const Domain domain(field);
  const BodySides<Number> sides(range, mode, apart);
  std::int64_t open_body = 0, tubes = 0;
  SurfaceTopology surface;
  surface.decided = for_each_euler(field, domain, sides, [&](const Stratum& stratum, int body) {
    if (body == 0) return;
    if (is_interior(domain, stratum))
      open_body += body;
    else if (stratum.dimension() == 0)
      tubes += voids_apart(domain, stratum.first);
  });
  surface.euler = 2 * (tubes - open_body);
  surface.components = surface_components(field, domain, sides);
  return surface;
}

template <class Number>
SurfaceTopology open_surface(const ScalarField& field, IsoRange range, BodyMode mode, const Number& apart) {
  const Domain domain(field);
  if (mode == BodyMode::sampled) return level_set(field, domain, ProductSides<Number>(range, apart));
  SurfaceTopology surface;
  for (const bool at_low : {true, false}) {
    const float level = at_low ? range.low : range.high;
    if (std::isinf(level)) continue;
    const SurfaceTopology sheet = level_set(field, domain, LevelSides<Number>(level, at_low, apart));
    surface.decided = surface.decided && sheet.decided;
    surface.euler += sheet.euler;
  }
  return surface;
}

// All finite numbers are multiples of 2^lowest and smaller than 2^highest.
struct Exponents {
  int lowest = 0, highest = 0;

  void widen(float f) {
    if (f == 0 || !std::isfinite(f)) return;
    lowest = std::min(lowest, std::max(std::ilogb(f) - 23, -149));
    highest = std::max(highest, std::ilogb(f) + 1);
  }
};

// A distance that decides ties and nothing else. Each sign that the oracle asks for is that of a polynomial of at most
// kDegree in the samples, the ends and the distance, whose coefficients, samples put in, are multiples of
// 2^(kDegree lowest): the first that is not zero must outweigh all that follow, with some bits for their factors.
mpq_class tie_breaker(const ScalarField& field, IsoRange range, BodyMode mode) {
  constexpr int kDegree = 6, kFactorBits = 40;
  Exponents bits;
  for (const float f : field.samples) bits.widen(f);
  for (const float end : {range.low, range.high}) bits.widen(end);
  if (mode == BodyMode::sampled) bits = {2 * bits.lowest, 2 * bits.highest + 2};  // products of two differences
  const int exponent = kDegree * (bits.highest - bits.lowest) - bits.highest + kFactorBits;
  return mpq_class(1, mpz_class(1) << static_cast<unsigned>(exponent));
}

}  // namespace

SurfaceTopology expected_surface(const ScalarField& field, IsoRange range, BodyMode mode, Arithmetic arithmetic) {
  if (arithmetic == Arithmetic::rounded) return closed_surface<long double>(field, range, mode, 0);
  return closed_surface(field, range, mode, tie_breaker(field, range, mode));
}

SurfaceTopology expected_open_surface(const ScalarField& field, IsoRange range, BodyMode mode, Arithmetic arithmetic) {
  if (arithmetic == Arithmetic::rounded) return open_surface<long double>(field, range, mode, 0);
  return open_surface(field, range, mode, tie_breaker(field, range, mode));
}

}  // namespace geosis::test
