// Costs of edges, eight at a time; see lanes.h.
#if defined(GEOSIS_SIMPLIFY_LANES_EDGE_COST_H) == defined(HWY_TARGET_TOGGLE)
#ifdef GEOSIS_SIMPLIFY_LANES_EDGE_COST_H
#undef GEOSIS_SIMPLIFY_LANES_EDGE_COST_H
#else
#define GEOSIS_SIMPLIFY_LANES_EDGE_COST_H
#endif

#include "engine/simplify/lanes/quadric.h"
#include "engine/simplify/merge_target.h"
#include "engine/simplify/placement.h"
#include "engine/simplify/rings.h"

HWY_BEFORE_NAMESPACE();
namespace geosis {
namespace HWY_NAMESPACE {

inline constexpr float kMidpointPull = 1e-3f;  // relative to the trace; 1e-2 costs 5 to 10 % of error
inline constexpr float kLengthWeight = 1e-5f;
inline constexpr float kFarthest2 = 2.0f;  // squared distance from the midpoint, in squared edge lengths

/// What is known at the edge's middle. The functions below are for one edge (float) and for eight (Float8) alike, with
/// selects instead of branches.
template <class F>
struct Middle {
  V3<F> gradient;  // half of it
  F value;
};

template <class F>
HWY_INLINE Middle<F> middle_of(const LaneQuadric<F>& q, V3<F> half) {
  const V3<F> gradient = q.b() + q.times(half);
  return {gradient, q.c + dot(q.b() + gradient, half)};
}

/// The y for which (A + pull) y = -g, by the LDL' factors of a symmetric 3x3 matrix.
template <class F>
HWY_INLINE V3<F> solve(const LaneQuadric<F>& q, V3<F> g) {
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

/// The best place relative to the edge's middle.
template <class F>
HWY_INLINE V3<F> best_offset(const LaneQuadric<F>& sum, V3<F> edge, const Middle<F>& middle) {
  const V3<F> y = solve(sum, middle.gradient);
  return select(dot(y, y) <= dot(edge, edge) * kFarthest2, y, V3<F>{});
}

/// The cheaper end; the quadratic term is the same at both.
template <class F>
HWY_INLINE V3<F> cheaper_end(V3<F> half, const Middle<F>& middle) {
  return select(dot(middle.gradient, half) < F{}, half, V3<F>{} - half);
}

template <class F, class M>
HWY_INLINE V3<F> at_ends(V3<F> offset, V3<F> half, M at_u, M at_v) {
  return select(at_v, half, select(at_u, V3<F>{} - half, offset));
}

/// Where u and v should merge, relative to u: the point of least cost of their summed quadric (given in u's frame), or
/// with Placement::subset the cheaper of the two ends.
///
/// edge     from u to v. The point is pulled a little towards the edge's midpoint, which gives flat and straight
///          regions, where A is singular, a solution; one that lies too far off is replaced by the midpoint.
HWY_INLINE Vec3f best_point(const Quadric& sum, Vec3f edge, MergeTarget target,
                            Placement placement = Placement::optimal) {
  const LaneQuadric<float> q = plain(sum);
  const V3<float> half = plain(edge) * 0.5f;
  const Middle<float> middle = middle_of(q, half);
  const V3<float> offset =
      placement == Placement::optimal ? best_offset(q, plain(edge), middle) : cheaper_end(half, middle);
  const V3<float> place = half + at_ends(offset, half, target == MergeTarget::at_u, target == MergeTarget::at_v);
  return {place.x, place.y, place.z};
}

/// The quadric of each of eight vertices, and where they are.
struct LaneVertices {
  V3<Float8> position;
  LaneQuadric<Float8> quadric;

  HWY_INLINE explicit LaneVertices(const WorkingVertex& v) : position(all8(v.position)), quadric(all8(v.quadric())) {}
  HWY_INLINE explicit LaneVertices(const WorkingVertex* const (&v)[kLanes]) {
    columns_of(v, 0, position.x, position.y, position.z, quadric.c);
    columns_of(v, 1, quadric.a00, quadric.a01, quadric.a02, quadric.b0);
    columns_of(v, 2, quadric.a11, quadric.a12, quadric.a22, quadric.b1);
    quadric.b2 = join(Float4{v[0]->b2, v[1]->b2, v[2]->b2, v[3]->b2}, Float4{v[4]->b2, v[5]->b2, v[6]->b2, v[7]->b2});
  }
};

/// Lanes whose vertices lie on the boundary.
HWY_INLINE Mask8 on_boundary(const WorkingVertex* const (&v)[kLanes]) {
  std::int32_t open[kLanes];
  for (int i = 0; i < kLanes; ++i) open[i] = -std::int32_t{v[i]->on_boundary};
  Mask8 mask;
  std::memcpy(&mask, open, sizeof(mask));
  return mask;
}

/// What to queue eight edges from u to v with: the merged quadric's value at its best point, plus a little of the
/// edge's length, so that flat regions have an order too. The functions of vertices give what lies on the boundary;
/// they are asked only if `may_be_open`.
template <class OpenU, class OpenV>
HWY_INLINE Float8 lane_costs(const LaneVertices& u, const LaneVertices& v, Placement placement, bool may_be_open,
                             const OpenU& open_u, const OpenV& open_v) {
  const V3<Float8> edge = v.position - u.position;
  const LaneQuadric<Float8> sum = sum_from(u.quadric, v.quadric, edge);
  const V3<Float8> half = edge * all8(0.5f);
  const Middle<Float8> middle = middle_of(sum, half);
  V3<Float8> offset = placement == Placement::optimal ? best_offset(sum, edge, middle) : cheaper_end(half, middle);
  if (may_be_open) {
    const Mask8 at_u = open_u(), at_v = open_v();
    offset = at_ends(offset, half, at_u & ~at_v, at_v & ~at_u);
  }
  const Float8 value = middle.value + dot(middle.gradient + middle.gradient + sum.times(offset), offset);
  return select(Float8{} < value, value, Float8{}) + sum.trace() * dot(edge, edge) * kLengthWeight;
}

/// Costs of eight edges from u[i] to v[i].
inline void edge_costs(const WorkingVertex* const (&u)[kLanes], const WorkingVertex* const (&v)[kLanes],
                       float (&costs)[kLanes], Placement placement = Placement::optimal) {
  bool may_be_open = false;
  for (int i = 0; i < kLanes; ++i) may_be_open |= u[i]->on_boundary | v[i]->on_boundary;
  const Float8 result = lane_costs(
      LaneVertices(u), LaneVertices(v), placement, may_be_open, [&]() HWY_ATTR { return on_boundary(u); },
      [&]() HWY_ATTR { return on_boundary(v); });
  std::memcpy(costs, &result, sizeof(result));
}

/// Costs of eight edges from one vertex u to v[i].
inline void edge_costs(const WorkingVertex& u, const WorkingVertex* const (&v)[kLanes], float* costs,
                       Placement placement = Placement::optimal) {
  bool may_be_open = u.on_boundary;
  for (int i = 0; i < kLanes; ++i) may_be_open |= v[i]->on_boundary;
  const auto open_u = [&]()
                          HWY_ATTR { return u.on_boundary ? all8(std::int32_t{0}) == all8(std::int32_t{0}) : Mask8{}; };
  const Float8 result = lane_costs(LaneVertices(u), LaneVertices(v), placement, may_be_open, open_u,
                                   [&]() HWY_ATTR { return on_boundary(v); });
  std::memcpy(costs, &result, sizeof(result));
}

}  // namespace HWY_NAMESPACE
}  // namespace geosis
HWY_AFTER_NAMESPACE();

#endif
