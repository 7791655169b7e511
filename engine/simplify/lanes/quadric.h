// Quadrics of eight vertices side by side; see lanes.h and ../quadric.h.
#if defined(GEOSIS_SIMPLIFY_LANES_QUADRIC_H) == defined(HWY_TARGET_TOGGLE)
#ifdef GEOSIS_SIMPLIFY_LANES_QUADRIC_H
#undef GEOSIS_SIMPLIFY_LANES_QUADRIC_H
#else
#define GEOSIS_SIMPLIFY_LANES_QUADRIC_H
#endif

#include "engine/simplify/lanes/lanes.h"
#include "engine/simplify/quadric.h"

HWY_BEFORE_NAMESPACE();
namespace geosis {
namespace HWY_NAMESPACE {

/// As QuadricOf, for F = Float8 or float.
template <class F>
struct LaneQuadric {
  F a00{}, a01{}, a02{}, a11{}, a12{}, a22{};
  F b0{}, b1{}, b2{};
  F c{};

  HWY_INLINE F trace() const { return a00 + a11 + a22; }
  HWY_INLINE V3<F> b() const { return {b0, b1, b2}; }
  HWY_INLINE V3<F> times(V3<F> x) const {
    return {a00 * x.x + a01 * x.y + a02 * x.z, a01 * x.x + a11 * x.y + a12 * x.z, a02 * x.x + a12 * x.y + a22 * x.z};
  }
};

HWY_INLINE LaneQuadric<float> plain(const Quadric& q) {
  return {q.a00, q.a01, q.a02, q.a11, q.a12, q.a22, q.b0, q.b1, q.b2, q.c};
}
HWY_INLINE LaneQuadric<Float8> all8(const Quadric& q) {
  return {all8(q.a00), all8(q.a01), all8(q.a02), all8(q.a11), all8(q.a12),
          all8(q.a22), all8(q.b0),  all8(q.b1),  all8(q.b2),  all8(q.c)};
}

/// The quadrics' sum, once q, whose origin lies at `origin`, is seen from p's frame.
HWY_INLINE LaneQuadric<Float8> sum_from(const LaneQuadric<Float8>& p, const LaneQuadric<Float8>& q, V3<Float8> origin) {
  const V3<Float8> e = q.times(origin);
  return {p.a00 + q.a00,       p.a01 + q.a01,
          p.a02 + q.a02,       p.a11 + q.a11,
          p.a12 + q.a12,       p.a22 + q.a22,
          p.b0 + (q.b0 - e.x), p.b1 + (q.b1 - e.y),
          p.b2 + (q.b2 - e.z), p.c + (q.c + dot(e - (q.b() + q.b()), origin))};
}

/// Adds weight * (normal . x)^2, as geosis::add_plane.
HWY_INLINE void add_planes(LaneQuadric<Float8>& q, V3<Float8> normal, Float8 weight) {
  const V3<Float8> w = normal * weight;
  q.a00 = q.a00 + w.x * normal.x;
  q.a01 = q.a01 + w.x * normal.y;
  q.a02 = q.a02 + w.x * normal.z;
  q.a11 = q.a11 + w.y * normal.y;
  q.a12 = q.a12 + w.y * normal.z;
  q.a22 = q.a22 + w.z * normal.z;
}

/// The matrices of eight quadrics without b and c, added up.
HWY_INLINE Quadric sum_of_planes(const LaneQuadric<Float8>& q) {
  const Float4 first = sums_of(q.a00, q.a01, q.a02, Float8{}), rest = sums_of(q.a11, q.a12, q.a22, Float8{});
  Quadric r;
  r.a00 = first[0], r.a01 = first[1], r.a02 = first[2];
  r.a11 = rest[0], r.a12 = rest[1], r.a22 = rest[2];
  return r;
}

}  // namespace HWY_NAMESPACE
}  // namespace geosis
HWY_AFTER_NAMESPACE();

#endif
