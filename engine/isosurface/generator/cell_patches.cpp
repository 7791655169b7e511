#include "engine/isosurface/generator/cell_patches.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <map>
#include <set>

#include "engine/base/vec3.h"
#include "engine/isosurface/cell.h"
#include "engine/isosurface/generator/cell_loops.h"

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

/// Whether edges a and b may be joined inside the cell: not in the plane of a face unless that chord is this cell's.
bool chord_allowed(const CellLoops& loops, int a, int b) {
  if (is_segment(loops, a, b)) return false;
  for (int face = 0; face < cell::kFaces; ++face) {
    int place_a = -1, place_b = -1;
    for (int m = 0; m < 4; ++m) {
      if (cell::face_edge(face, m) == a) place_a = m;
      if (cell::face_edge(face, m) == b) place_b = m;
    }
    if (place_a >= 0 && place_b >= 0) return chord::allowed(face, place_a, place_b);
  }
  return true;
}

/// Whether segment ab passes through the inside of triangle t.
bool pierces(Vec3d a, Vec3d b, const std::array<Vec3d, 3>& t) {
  constexpr double kTouch = 1e-9;
  const auto side = [](Vec3d p, Vec3d q, Vec3d r, Vec3d s) { return dot(cross(q - p, r - p), s - p); };
  const double sa = side(t[0], t[1], t[2], a), sb = side(t[0], t[1], t[2], b);
  if (!((sa > kTouch && sb < -kTouch) || (sa < -kTouch && sb > kTouch))) return false;
  const double u = side(a, b, t[0], t[1]), v = side(a, b, t[1], t[2]), w = side(a, b, t[2], t[0]);
  return (u > kTouch && v > kTouch && w > kTouch) || (u < -kTouch && v < -kTouch && w < -kTouch);
}

bool triangles_cut(const std::array<Vec3d, 3>& s, const std::array<Vec3d, 3>& t) {
  for (int n = 0; n < 3; ++n) {
    if (pierces(s[n], s[(n + 1) % 3], t) || pierces(t[n], t[(n + 1) % 3], s)) return true;
  }
  return false;
}

/// Judges triangles by the witnesses: the sum of their areas (small where the patch hugs the surface), and the number
/// of witnesses in which they cut each other.
class PatchCost {
 public:
  explicit PatchCost(const StateWitnesses& witnesses) {
    for (const Field& field : witnesses.fields) positions_.push_back(vertex_positions(field));
  }
  double of(const PatchTriangle& t) const {
    double sum = 0;
    for (const auto& p : positions_) sum += norm(cross(p[t[1]] - p[t[0]], p[t[2]] - p[t[0]]));
    return sum;
  }
  int cuts(const std::vector<PatchTriangle>& triangles) const {
    int faulty = 0;
    for (const auto& position : positions_) faulty += has_cut(triangles, position);
    return faulty;
  }

 private:
  using Positions = std::array<Vec3d, cell::kEdges>;

  static bool has_cut(const std::vector<PatchTriangle>& triangles, const Positions& p) {
    for (const auto& s : triangles) {
      for (const auto& t : triangles) {
        if (&s < &t && triangles_cut({p[s[0]], p[s[1]], p[s[2]]}, {p[t[0]], p[t[1]], p[t[2]]})) return true;
      }
    }
    return false;
  }

  std::vector<Positions> positions_;
};

/// Cheapest triangulation of a polygon without forbidden chords, by dynamic programming over its sub-polygons.
class DiscSearch {
 public:
  DiscSearch(const CellLoops& loops, const std::vector<int>& polygon, const PatchCost& cost)
      : loops_(loops), polygon_(polygon), cost_(cost) {}

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
    return is_boundary || chord_allowed(loops_, polygon_[a], polygon_[b]);
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

  const CellLoops& loops_;
  const std::vector<int>& polygon_;
  const PatchCost& cost_;
  std::map<std::pair<int, int>, Choice> memory_;
};

/// Walks round the annulus between loops p (forwards) and q (backwards) by bridges from one to the other, and keeps the
/// cheapest set of triangles. With a cone, one stretch between two bridges is filled by a fan around the interior
/// vertex instead of a strip.
class AnnulusSearch {
 public:
  AnnulusSearch(const CellLoops& loops, const std::vector<int>& p, const std::vector<int>& q, const PatchCost& cost)
      : loops_(loops), p_(p), q_(q), cost_(cost) {}

  bool run(std::vector<PatchTriangle>& out) {
    for (int p0 = 0; p0 < size(p_); ++p0) {
      for (int q0 = 0; q0 < size(q_); ++q0) {
        if (bridge_allowed(p0, q0)) walk(p0, 0, q0, 0, 0, size(p_), size(q_));
      }
    }
    return take(out);
  }

 private:
  static constexpr double kCutCost = 1e3;  // more than any sum of areas

  static int size(const std::vector<int>& loop) { return static_cast<int>(loop.size()); }
  int p_at(int n) const { return p_[static_cast<std::size_t>(n) % p_.size()]; }
  int q_at(int start, int steps) const {
    return q_[static_cast<std::size_t>(start + 2 * size(q_) - steps) % q_.size()];
  }
  bool bridge_allowed(int p, int q) const { return chord_allowed(loops_, p_at(p), q_at(q, 0)); }

  // From bridge (p0 + i, q0 - j) on, until all steps are done.
  void walk(int p0, int i, int q0, int j, double cost, int p_steps, int q_steps) {
    if (i == p_steps && j == q_steps) {
      finish(cost);
      return;
    }
    const bool full_turn = p_steps == size(p_) && q_steps == size(q_);
    for (int n = 1; i + n <= p_steps && n < size(p_); ++n) step_p(p0, i, n, q0, j, cost, p_steps, q_steps);
    if (full_turn && i == 0) return;  // a full turn starts with a step on p
    for (int n = 1; j + n <= q_steps && n < size(q_); ++n) step_q(p0, i, q0, j, n, cost, p_steps, q_steps);
  }

  // A triangle over n segments of loop p; for n > 1 its base is a chord, and what the chord cuts off is a disc.
  void step_p(int p0, int i, int n, int q0, int j, double cost, int p_steps, int q_steps) {
    const int p = p_at(p0 + i), p_next = p_at(p0 + i + n), q = q_at(q0, j);
    const bool last = i + n == p_steps && j == q_steps;
    if (!last && !chord_allowed(loops_, p_next, q)) return;
    std::vector<int> ear;
    for (int m = 0; m <= n; ++m) ear.push_back(p_at(p0 + i + m));
    step({p, p_next, q}, ear, p0, i + n, q0, j, cost, p_steps, q_steps);
  }

  void step_q(int p0, int i, int q0, int j, int n, double cost, int p_steps, int q_steps) {
    const int p = p_at(p0 + i), q = q_at(q0, j), q_next = q_at(q0, j + n);
    const bool last = i == p_steps && j + n == q_steps;
    if (!last && !chord_allowed(loops_, p, q_next)) return;
    std::vector<int> ear;
    for (int m = n; m >= 0; --m) ear.push_back(q_at(q0, j + m));
    step({q_next, q, p}, ear, p0, i, q0, j + n, cost, p_steps, q_steps);
  }

  void step(const PatchTriangle& t, const std::vector<int>& ear, int p0, int i, int q0, int j, double cost, int p_steps,
            int q_steps) {
    if (ear.size() > 2 && !chord_allowed(loops_, ear.front(), ear.back())) return;
    const std::size_t before = current_.size();
    current_.push_back(t);
    if (DiscSearch(loops_, ear, cost_).run(current_)) {
      for (std::size_t n = before; n < current_.size(); ++n) cost += cost_.of(current_[n]);
      walk(p0, i, q0, j, cost, p_steps, q_steps);
    }
    current_.resize(before);
  }

  void finish(double cost) {
    if (cost >= best_cost_ || has_repeated_edge()) return;
    cost += kCutCost * cost_.cuts(current_);
    if (cost >= best_cost_) return;
    best_cost_ = cost;
    best_ = current_;
  }

  bool has_repeated_edge() const {
    std::set<std::pair<int, int>> directed;
    for (const auto& t : current_) {
      for (int n = 0; n < 3; ++n) {
        if (!directed.insert({t[n], t[(n + 1) % 3]}).second) return true;
      }
    }
    return false;
  }

  bool take(std::vector<PatchTriangle>& out) {
    out.insert(out.end(), best_.begin(), best_.end());
    return !best_.empty();
  }

  const CellLoops& loops_;
  const std::vector<int>&p_, &q_;
  const PatchCost& cost_;
  std::vector<PatchTriangle> current_, best_;
  double best_cost_ = std::numeric_limits<double>::infinity();
};

/// The two loops that the tunnel joins; {-1, -1} without one.
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

using Edge = std::pair<int, int>;

std::map<Edge, int> directed_edges(const std::vector<PatchTriangle>& triangles) {
  std::map<Edge, int> count;
  for (const auto& t : triangles) {
    for (int n = 0; n < 3; ++n) ++count[{t[n], t[(n + 1) % 3]}];
  }
  return count;
}

}  // namespace

CellPatch fill_loops(const CellState& state, const StateWitnesses& witnesses) {
  const CellLoops loops = trace_loops(state.above, state.joined_faces);
  const PatchCost cost(witnesses);
  CellPatch patch;
  const auto [p, q] = tunnel_loops(state, witnesses, loops);
  if (p >= 0) {
    AnnulusSearch(loops, loops.loops[p], loops.loops[q], cost).run(patch);
  }
  for (int n = 0; n < static_cast<int>(loops.loops.size()); ++n) {
    if (n != p && n != q) DiscSearch(loops, loops.loops[n], cost).run(patch);
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
    if (has_twin && !chord_allowed(loops, a, b)) return "a chord is forbidden";
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

int count_self_intersections(const StateWitnesses& witnesses, const CellPatch& patch) {
  return PatchCost(witnesses).cuts(patch);
}

}  // namespace geosis::generator
