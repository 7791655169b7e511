#include "engine/isosurface/generator/cell_patches.h"

#include <algorithm>
#include <limits>
#include <map>
#include <set>

#include "engine/base/vec3.h"
#include "engine/isosurface/cell.h"
#include "engine/isosurface/mc33_tables.h"

namespace geosis::generator {
namespace {

Vec3d corner_position(int corner) {
  return {corner & 4 ? 1.0 : 0.0, corner & 2 ? 1.0 : 0.0, corner & 1 ? 1.0 : 0.0};
}

/// Place of every crossed edge's vertex in one witness.
std::array<Vec3d, cell::kEdges> vertex_positions(const Field& field) {
  std::array<Vec3d, cell::kEdges> position{};
  for (int e = 0; e < cell::kEdges; ++e) {
    const int a = cell::edge_start(e), b = cell::edge_end(e);
    if ((field[a] > 0) == (field[b] > 0)) continue;
    const double t = field[a] / (field[a] - field[b]);
    position[e] = corner_position(a) + (corner_position(b) - corner_position(a)) * t;
  }
  return position;
}

using Positions = std::array<Vec3d, cell::kEdges>;

double twice_area(const Positions& p, const PatchTriangle& t) {
  return norm(cross(p[t[1]] - p[t[0]], p[t[2]] - p[t[0]]));
}

/// Judges triangles by the witnesses: the sum of their areas, small where the patch hugs the surface.
class PatchCost {
 public:
  explicit PatchCost(const StateWitnesses& witnesses) {
    for (const Field& field : witnesses.fields) positions_.push_back(vertex_positions(field));
  }
  double of(const PatchTriangle& t) const {
    double sum = 0;
    for (const auto& p : positions_) sum += twice_area(p, t);
    return sum;
  }

 private:
  std::vector<Positions> positions_;
};

/// Cheapest triangulation of a polygon without forbidden chords, by dynamic programming over its sub-polygons.
class DiscSearch {
 public:
  DiscSearch(const CellState& state, const CellLoops& loops, const std::vector<int>& polygon, const PatchCost& cost)
      : state_(state), loops_(loops), polygon_(polygon), cost_(cost) {}

  bool run(std::vector<PatchTriangle>& out) {
    const int n = static_cast<int>(polygon_.size());
    if (n < 3) return true;
    if (best(0, n - 1).cost == kImpossible) return false;
    collect(0, n - 1, out);
    return true;
  }

 private:
  static constexpr double kImpossible = std::numeric_limits<double>::infinity();
  struct Choice {
    double cost = kImpossible;
    int apex = -1;
  };

  bool side_allowed(int a, int b) const {
    const int n = static_cast<int>(polygon_.size());
    const bool is_boundary = b - a == 1 || (a == 0 && b == n - 1);
    return is_boundary || chord_allowed(state_, loops_, polygon_[a], polygon_[b]);
  }

  // Sub-polygon a, a + 1, ..., b, closed by the chord (a, b).
  Choice best(int a, int b) {
    if (b - a < 2) return {.cost = 0, .apex = -1};
    if (const auto known = memory_.find({a, b}); known != memory_.end()) return known->second;
    Choice choice;
    for (int m = a + 1; m < b; ++m) {
      if (!side_allowed(a, m) || !side_allowed(m, b)) continue;
      const double cost =
          cost_.of(PatchTriangle{polygon_[a], polygon_[m], polygon_[b]}) + best(a, m).cost + best(m, b).cost;
      if (cost < choice.cost) choice = {.cost = cost, .apex = m};
    }
    memory_[{a, b}] = choice;
    return choice;
  }

  void collect(int a, int b, std::vector<PatchTriangle>& out) {
    const int apex = best(a, b).apex;
    if (apex < 0) return;
    out.push_back({polygon_[a], polygon_[apex], polygon_[b]});
    collect(a, apex, out);
    collect(apex, b, out);
  }

  const CellState& state_;
  const CellLoops& loops_;
  const std::vector<int>& polygon_;
  const PatchCost& cost_;
  std::map<std::pair<int, int>, Choice> memory_;
};

using Edge = std::pair<int, int>;

std::map<Edge, int> directed_edges(const std::vector<PatchTriangle>& triangles) {
  std::map<Edge, int> count;
  for (const auto& t : triangles) {
    for (int n = 0; n < 3; ++n) ++count[{t[n], t[(n + 1) % 3]}];
  }
  return count;
}

}  // namespace

std::array<int, 2> tunnel_loops(const CellState& state, const StateWitnesses& witnesses, const CellLoops& loops) {
  if (state.tunnel == Tunnel::none) return {-1, -1};
  const auto& joined = state.tunnel == Tunnel::above ? loops.above : loops.below;
  const auto& pierced = state.tunnel == Tunnel::above ? loops.below : loops.above;
  for (int a = 0; a < static_cast<int>(joined.size()); ++a) {
    for (int b = 0; b < static_cast<int>(joined.size()); ++b) {
      if (joined[a] == witnesses.joint[0] && joined[b] == witnesses.joint[1] && pierced[a] == pierced[b]) return {a, b};
    }
  }
  return {-1, -1};
}

FaceChord face_chord(int a, int b) {
  for (int face = 0; face < cell::kFaces; ++face) {
    FaceChord chord{.face = face, .a = -1, .b = -1};
    for (int m = 0; m < 4; ++m) {
      if (cell::face_edge(face, m) == a) chord.a = m;
      if (cell::face_edge(face, m) == b) chord.b = m;
    }
    if (chord.a >= 0 && chord.b >= 0) return chord;
  }
  return {};
}

bool chord_allowed(const CellState& state, const CellLoops& loops, int a, int b) {
  if (a == kInnerVertex || b == kInnerVertex) return true;
  if (is_segment(loops, a, b)) return false;
  const FaceChord chord = face_chord(a, b);
  if (chord.face < 0) return true;
  const chord::FaceState face{.first_above = ((state.above >> cell::face_corner(chord.face, 0)) & 1) != 0,
                              .joined_above = ((state.joined_faces >> chord.face) & 1) != 0};
  return chord::allowed(chord.face, face, chord.a, chord.b);
}

double area_of(const StateWitnesses& witnesses, const CellPatch& patch) {
  const PatchCost cost(witnesses);
  double sum = 0;
  for (const auto& triangle : patch) sum += cost.of(triangle);
  return sum;
}

CellPatch fill_discs(const CellState& state, const StateWitnesses& witnesses) {
  const CellLoops loops = trace_loops(state.above, state.joined_faces);
  const PatchCost cost(witnesses);
  const auto [p, q] = tunnel_loops(state, witnesses, loops);
  CellPatch patch;
  for (int n = 0; n < static_cast<int>(loops.loops.size()); ++n) {
    if (n != p && n != q) DiscSearch(state, loops, loops.loops[n], cost).run(patch);
  }
  return patch;
}

std::string find_fault(const CellState& state, const CellPatch& patch) {
  const CellLoops loops = trace_loops(state.above, state.joined_faces);
  std::set<Edge> boundary;
  for (const auto& loop : loops.loops) {
    for (std::size_t n = 0; n < loop.size(); ++n) boundary.insert({loop[n], loop[(n + 1) % loop.size()]});
  }
  const auto edges = directed_edges(patch);
  std::set<int> vertices;
  long undirected = 0;
  for (const auto& [edge, count] : edges) {
    const auto [a, b] = edge;
    vertices.insert(a);
    const bool has_twin = edges.contains({b, a});
    if (count != 1) return "an edge is used twice in one direction";
    if (has_twin == boundary.contains(edge)) return "the boundary is not the loops";
    if (has_twin && !chord_allowed(state, loops, a, b)) return "a chord is forbidden";
    undirected += has_twin ? (a < b ? 1 : 0) : 1;
  }
  for (const auto& edge : boundary) {
    if (!edges.contains(edge)) return "a loop is left open";
  }
  const long discs = static_cast<long>(loops.loops.size()) - (state.tunnel == Tunnel::none ? 0 : 2);
  const long euler = static_cast<long>(vertices.size()) - undirected + static_cast<long>(patch.size());
  if (euler != discs) return "the Euler characteristic is wrong";
  return {};
}

}  // namespace geosis::generator
