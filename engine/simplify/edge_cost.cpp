#include "engine/simplify/edge_cost.h"

#include <algorithm>
#include <cassert>

namespace geosis {
namespace {

constexpr float kMidpointPull = 1e-3f;  // relative to the trace; 1e-2 costs 5 to 10 % of error, 1e-4 gains nothing
constexpr float kLengthWeight = 1e-4f;
constexpr float kFarthest2 = 2.0f;  // squared distance from the midpoint, in squared edge lengths
constexpr float kTiny = 1e-20f;     // keeps pivots of an empty quadric from zero

/// What is known at the edge's middle. The functions below are for one edge (float) and for four (Float4) alike, with
/// selects instead of branches.
template <class F>
struct Middle {
  Vec3<F> gradient;  // half of it
  F value;
};

template <class F>
inline Middle<F> middle_of(const QuadricOf<F>& q, Vec3<F> half) {
  const Vec3<F> gradient = q.b() + q.times(half);
  return {gradient, q.c + dot(q.b() + gradient, half)};
}

/// The y for which (A + pull) y = -g, by the LDL' factors of a symmetric 3x3 matrix.
template <class F>
inline Vec3<F> solve(const QuadricOf<F>& q, Vec3<F> g) {
  const F pull = q.trace() * kMidpointPull + kTiny;
  const F i0 = 1.0f / (q.a00 + pull);
  const F l1 = q.a01 * i0;
  const F l2 = q.a02 * i0;
  const F i1 = 1.0f / (q.a11 + pull - l1 * q.a01);
  const F t = q.a12 - l1 * q.a02;
  const F l3 = t * i1;
  const F d2 = q.a22 + pull - l2 * q.a02 - l3 * t;
  const F r1 = g.y - l1 * g.x;
  const F r2 = g.z - l2 * g.x - l3 * r1;
  const F z = -r2 / d2;
  const F y = -r1 * i1 - l3 * z;
  const F x = -g.x * i0 - l1 * y - l2 * z;
  return {x, y, z};
}

template <class F, class M>
inline Vec3<F> choose(M condition, Vec3<F> yes, Vec3<F> no) {
  return {select(condition, yes.x, no.x), select(condition, yes.y, no.y), select(condition, yes.z, no.z)};
}

/// The best place relative to the edge's middle.
template <class F>
inline Vec3<F> best_offset(const QuadricOf<F>& sum, Vec3<F> edge, const Middle<F>& middle) {
  const Vec3<F> y = solve(sum, middle.gradient);
  return choose(dot(y, y) <= dot(edge, edge) * kFarthest2, y, Vec3<F>{});
}

/// The cheaper end; the quadratic term is the same at both.
template <class F>
inline Vec3<F> cheaper_end(Vec3<F> half, const Middle<F>& middle) {
  return choose(dot(middle.gradient, half) < F{}, half, Vec3<F>{} - half);
}

template <class F, class M>
inline Vec3<F> at_ends(Vec3<F> offset, Vec3<F> half, M at_u, M at_v) {
  return choose(at_v, half, choose(at_u, Vec3<F>{} - half, offset));
}

/// The neighbours' records, one a lane.
struct Lanes {
  Vec3<Float4> edge;
  QuadricOf<Float4> q;
};

inline Lanes gather(Vec3f from, const WorkingVertex& v0, const WorkingVertex& v1, const WorkingVertex& v2,
                    const WorkingVertex& v3) {
  Float4 x = v0.row(0), y = v1.row(0), z = v2.row(0), c = v3.row(0);
  Float4 a00 = v0.row(1), a01 = v1.row(1), a02 = v2.row(1), b0 = v3.row(1);
  Float4 a11 = v0.row(2), a12 = v1.row(2), a22 = v2.row(2), b1 = v3.row(2);
  transpose(x, y, z, c);
  transpose(a00, a01, a02, b0);
  transpose(a11, a12, a22, b1);
  return {Vec3<Float4>{x, y, z} - all4(from),
          {a00, a01, a02, a11, a12, a22, b0, b1, Float4{v0.b2, v1.b2, v2.b2, v3.b2}, c}};
}

inline QuadricOf<Float4> all4(const Quadric& q) {
  using geosis::all4;
  return {all4(q.a00), all4(q.a01), all4(q.a02), all4(q.a11), all4(q.a12),
          all4(q.a22), all4(q.b0),  all4(q.b1),  all4(q.b2),  all4(q.c)};
}

/// u_open is all ones or all zeros; open, the neighbours' lanes.
inline Vec3<Float4> respect_boundary(Vec3<Float4> offset, Vec3<Float4> half, Mask4 u_open, Mask4 open) {
  return at_ends(offset, half, u_open & ~open, open & ~u_open);
}

template <bool kMayBeOpen>
inline Float4 lane_costs(const QuadricOf<Float4>& u, Mask4 u_open, Mask4 open, const Lanes& lanes,
                         Placement placement) {
  const QuadricOf<Float4> sum = u + seen_from(lanes.q, lanes.edge);
  const Vec3<Float4> half = lanes.edge * geosis::all4(0.5f);
  const Middle<Float4> middle = middle_of(sum, half);
  Vec3<Float4> offset =
      placement == Placement::optimal ? best_offset(sum, lanes.edge, middle) : cheaper_end(half, middle);
  if (kMayBeOpen) offset = respect_boundary(offset, half, u_open, open);
  const Float4 value = middle.value + dot(middle.gradient + middle.gradient + sum.times(offset), offset);
  return select(value > 0.0f, value, Float4{}) + sum.trace() * dot(lanes.edge, lanes.edge) * kLengthWeight;
}

}  // namespace

Vec3f best_point(const Quadric& sum, Vec3f edge, MergeTarget target, Placement placement) {
  const Vec3f half = edge * 0.5f;
  const Middle<float> middle = middle_of(sum, half);
  const Vec3f offset = placement == Placement::optimal ? best_offset(sum, edge, middle) : cheaper_end(half, middle);
  return half + at_ends(offset, half, target == MergeTarget::at_u, target == MergeTarget::at_v);
}

void edge_costs(std::span<const WorkingVertex> vertices, LocalVertex u, std::span<const LocalVertex> neighbours,
                std::span<float> costs, Placement placement) {
  assert(costs.size() >= (neighbours.size() + kLanes - 1) / kLanes * kLanes);
  const WorkingVertex& from = vertices[u];
  const QuadricOf<Float4> quadric = all4(from.quadric());
  const std::size_t last = neighbours.size() - 1;
  for (std::size_t first = 0; first < neighbours.size(); first += kLanes) {
    const auto neighbour = [&](std::size_t i) -> const WorkingVertex& {
      return vertices[neighbours[std::min(first + i, last)]];
    };
    const WorkingVertex &v0 = neighbour(0), &v1 = neighbour(1), &v2 = neighbour(2), &v3 = neighbour(3);
    const Lanes lanes = gather(from.position, v0, v1, v2, v3);
    Float4 result;
    if (from.on_boundary | v0.on_boundary | v1.on_boundary | v2.on_boundary | v3.on_boundary) {
      const Mask4 open = Mask4{v0.on_boundary, v1.on_boundary, v2.on_boundary, v3.on_boundary} != 0;
      const Mask4 u_open = Mask4{} - static_cast<std::int32_t>(from.on_boundary);
      result = lane_costs<true>(quadric, u_open, open, lanes, placement);
    } else {
      result = lane_costs<false>(quadric, Mask4{}, Mask4{}, lanes, placement);
    }
    std::memcpy(&costs[first], &result, sizeof(result));
  }
}

}  // namespace geosis
