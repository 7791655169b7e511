#include "engine/simplify/edge_cost.h"

#include <algorithm>
#include <array>
#include <cassert>

namespace geosis {
namespace {

constexpr float kMidpointPull = 1e-3f;  // relative to the trace; 1e-2 costs 5 to 10 % of error, 1e-4 gains nothing
constexpr float kLengthWeight = 1e-4f;
constexpr float kFarthest2 = 2.0f;  // squared distance from the midpoint, in squared edge lengths
constexpr float kTiny = 1e-20f;     // keeps pivots of an empty quadric from zero

constexpr float end_of(MergeTarget target) {
  return target == MergeTarget::at_u ? -1.0f : target == MergeTarget::at_v ? 1.0f : 0.0f;
}

/// The y for which (A + pull) y = -g, by the LDL' factors of a symmetric 3x3 matrix.
inline Vec3f solve(const Quadric& q, Vec3f g) {
  const float pull = kMidpointPull * q.trace() + kTiny;
  const float i0 = 1.0f / (q.a00 + pull);
  const float l1 = q.a01 * i0;
  const float l2 = q.a02 * i0;
  const float i1 = 1.0f / (q.a11 + pull - l1 * q.a01);
  const float t = q.a12 - l1 * q.a02;
  const float l3 = t * i1;
  const float d2 = q.a22 + pull - l2 * q.a02 - l3 * t;
  const float r1 = g.y - l1 * g.x;
  const float r2 = g.z - l2 * g.x - l3 * r1;
  const float z = -r2 / d2;
  const float y = -r1 * i1 - l3 * z;
  const float x = -g.x * i0 - l1 * y - l2 * z;
  return {x, y, z};
}

/// Where to merge relative to the edge's midpoint; `end` is -1 for u, 1 for v, 0 for the best place. Selects and
/// products instead of branches, so that a loop over lanes becomes vector code.
inline Vec3f offset_from_middle(const Quadric& sum, Vec3f edge, float end) {
  const Vec3f half = edge * 0.5f;
  const Vec3f y = solve(sum, Vec3f{sum.b0, sum.b1, sum.b2} + sum.times(half));
  const float limit2 =
      kFarthest2 * dot(edge, edge) * (1.0f - end * end) - end * end;  // below zero: only the end will do
  const float length2 = dot(y, y);
  const float x0 = length2 <= limit2 ? y.x : end * half.x;
  const float x1 = length2 <= limit2 ? y.y : end * half.y;
  const float x2 = length2 <= limit2 ? y.z : end * half.z;
  return {x0, x1, x2};
}

/// Neighbours side by side, one a lane.
struct Lanes {
  template <class T>
  using Row = std::array<T, kCostLanes>;
  alignas(32) std::array<Row<float>, 10> q;
  alignas(32) std::array<Row<float>, 3> edge;
  alignas(32) Row<float> end;

  Quadric quadric(std::size_t i) const {
    return {q[0][i], q[1][i], q[2][i], q[3][i], q[4][i], q[5][i], q[6][i], q[7][i], q[8][i], q[9][i]};
  }

  void set(std::size_t i, const WorkingVertex& u, const WorkingVertex& v) {
    const Quadric& p = v.quadric;
    const float values[] = {p.a00, p.a01, p.a02, p.a11, p.a12, p.a22, p.b0, p.b1, p.b2, p.c};
    for (std::size_t k = 0; k < 10; ++k) q[k][i] = values[k];
    for (int k = 0; k < 3; ++k) edge[k][i] = v.position[k] - u.position[k];
    end[i] = end_of(merge_target(u, v));
  }
};

void lane_costs(const Quadric& u, const Lanes& lanes, float* costs) {
  for (std::size_t i = 0; i < kCostLanes; ++i) {
    const Vec3f edge{lanes.edge[0][i], lanes.edge[1][i], lanes.edge[2][i]};
    const Quadric sum = u + seen_from(lanes.quadric(i), edge);
    const float value = sum.value(edge * 0.5f + offset_from_middle(sum, edge, lanes.end[i]));
    costs[i] = (value > 0.0f ? value : 0.0f) + kLengthWeight * sum.trace() * dot(edge, edge);
  }
}

}  // namespace

Vec3f best_point(const Quadric& sum, Vec3f edge, MergeTarget target) {
  return edge * 0.5f + offset_from_middle(sum, edge, end_of(target));
}

void edge_costs(std::span<const WorkingVertex> vertices, LocalVertex u, std::span<const LocalVertex> neighbours,
                std::span<float> costs) {
  assert(costs.size() >= (neighbours.size() + kCostLanes - 1) / kCostLanes * kCostLanes);
  Lanes lanes;
  for (std::size_t first = 0; first < neighbours.size(); first += kCostLanes) {
    for (std::size_t i = 0; i < kCostLanes; ++i) {
      const std::size_t neighbour = std::min(first + i, neighbours.size() - 1);
      lanes.set(i, vertices[u], vertices[neighbours[neighbour]]);
    }
    lane_costs(vertices[u].quadric, lanes, &costs[first]);
  }
}

}  // namespace geosis
