#include "tests/support/solid_oracle.h"

#include <cmath>

#include "tests/support/cell_topology.h"
#include "tests/support/range_sides.h"
#include "tests/support/union_find.h"

namespace geosis::test {
namespace {

CellTopology topology_of(const ScalarField& field, const BodySides<long double>& sides, GridIndex cell) {
  CellCorners<long double> corners;
  bool uniform = true;
  for (int c = 0; c < 8; ++c) {
    corners[c] = sides.corner(field.at(cell + unit_corner(c)));
    uniform = uniform && corners[c].side == corners[0].side;
  }
  if (!uniform) return cell_topology(corners);
  CellTopology topology;
  topology.bands = corners[0].side == Side::inside ? 1 : 0;
  topology.band_of_edge.fill(static_cast<std::int8_t>(topology.bands - 1));
  return topology;
}

bool faces_decided(const ScalarField& field, const BodySides<long double>& sides, GridIndex cell) {
  bool decided = true;
  for (int normal = 0; normal < 3; ++normal) {
    GridIndex u, v;
    u[normal == 0 ? 1 : 0] = 1;
    v[normal == 2 ? 1 : 2] = 1;
    for (int side = 0; side < 2; ++side) {
      GridIndex start = cell;
      start[normal] += side;
      const auto corner = [&](GridIndex n) { return sides.corner(field.at(n)); };
      const SquareCorners<long double> square{corner(start), corner(start + u), corner(start + u + v),
                                              corner(start + v)};
      for (int outside = 0; outside < kOutsides; ++outside) {
        decided = decided && !decide_square(square, outside).tied;
      }
    }
  }
  return decided;
}

// Low and high end at one place of an edge may hide the band between them, where a saddle is there as well.
bool edges_decided(const ScalarField& field, const BodySides<long double>& sides, GridIndex cell,
                   const std::array<std::int8_t, 12>& band_of_edge) {
  bool decided = true;
  for (int e = 0; e < 12; ++e) {
    GridIndex start = cell;
    start[e < 4 ? 1 : 0] += e >> 1 & 1;
    start[e < 8 ? 2 : 1] += e & 1;
    GridIndex end = start;
    ++end[e / 4];
    const Side from = sides.side(field.at(start)), to = sides.side(field.at(end));
    decided = decided && (from != to || from == Side::inside) == (band_of_edge[e] >= 0);
  }
  return decided;
}

// An edge of the cell along the axis, from the corner with the given offsets; the axis's own offset does not matter.
int edge_at(int axis, GridIndex offset) {
  return cell_edge(axis, axis == 0 ? offset.j : offset.i, axis == 2 ? offset.j : offset.k);
}

}  // namespace

SolidOracle::SolidOracle(const ScalarField& field, IsoRange range, BodyMode mode)
    : nodes_(field.shape), domain_(field), of_edge_(static_cast<std::size_t>(field.shape.count())) {
  for (auto& edges : of_edge_) edges.fill(-1);
  join_cells(field, range, mode);
  place_nodes(field, range, mode);
}

void SolidOracle::join_cells(const ScalarField& field, IsoRange range, BodyMode mode) {
  const BodySides<long double> sides(range, mode, 0);
  UnionFind bands;
  for_each_node(domain_.cells(), [&](GridIndex cell) {
    if (!domain_.has(cell)) return;
    const CellTopology topology = topology_of(field, sides, cell);
    decided_ = decided_ && topology.decided && faces_decided(field, sides, cell) &&
               edges_decided(field, sides, cell, topology.band_of_edge);
    std::array<std::int32_t, 8> band{};
    for (int n = 0; n < topology.bands; ++n) band[n] = bands.add();
    auto& edges = of_edge_[index(cell)];
    for (int e = 0; e < 12; ++e) edges[e] = topology.band_of_edge[e] < 0 ? -1 : band[topology.band_of_edge[e]];
    for (int normal = 0; normal < 3; ++normal) {
      GridIndex before = cell;
      if (--before[normal] < 0) continue;
      for (int axis = 0; axis < 3; ++axis) {
        for (int corner = 0; corner < 8; ++corner) {
          GridIndex here = unit_corner(corner), there = here;
          if (axis == normal || here[axis] == 1 || here[normal] == 1) continue;
          there[normal] = 1;
          const std::int32_t a = edges[edge_at(axis, here)], b = of_edge_[index(before)][edge_at(axis, there)];
          if (a >= 0 && b >= 0) bands.unite(a, b);
        }
      }
    }
  });
  std::vector<std::int32_t> body;  // [root of its bands]
  for (auto& edges : of_edge_) {
    for (std::int32_t& band : edges) {
      if (band < 0) continue;
      const auto root = static_cast<std::size_t>(bands.find(band));
      if (root >= body.size()) body.resize(root + 1, -1);
      if (body[root] < 0) {
        body[root] = bodies();
        voxels_.push_back(0);
      }
      band = body[root];
    }
  }
}

void SolidOracle::place_nodes(const ScalarField& field, IsoRange range, BodyMode mode) {
  const BodySides<long double> sides(range, mode, 0);
  of_node_.assign(static_cast<std::size_t>(nodes_.count()), -1);
  for_each_node(nodes_, [&](GridIndex node) {
    if (sides.side(field.at(node)) != Side::inside) return;
    for (int c = 7; c >= 0; --c) {  // the cells around the node, first one first
      const GridIndex cell = node - unit_corner(c);
      if (!domain_.has(cell)) continue;
      of_node_[index(node)] = of_edge_[index(cell)][edge_at(0, unit_corner(c))];
      ++voxels_[of_node_[index(node)]];
      return;
    }
  });
}

std::set<std::int32_t> SolidOracle::bodies_at(Vec3f position) const {
  GridIndex start;
  int axis = -1;
  for (int n = 0; n < 3; ++n) {
    start[n] = static_cast<std::int32_t>(std::floor(position[n]));
    if (position[n] != std::floor(position[n])) axis = n;
  }
  std::set<std::int32_t> found;
  for (int c = 0; c < 8; ++c) {
    const GridIndex cell = start - unit_corner(c);
    if (!domain_.has(cell) || (axis >= 0 && unit_corner(c)[axis] == 1)) continue;
    found.insert(of_edge_[index(cell)][edge_at(axis < 0 ? 0 : axis, unit_corner(c))]);
  }
  return found;
}

}  // namespace geosis::test
