#pragma once

#include "engine/base/vec3.h"
#include "engine/simplify/float4.h"

namespace geosis {

/// The function x'Ax + 2b'x + c: a sum of squared distances to planes, each weighted by an area. F is float, or Float4
/// for four functions side by side.
///
/// Every vertex keeps its quadric in its own frame, with the vertex at the origin. There b and c are as small as the
/// error itself, so float32 does at any coordinate; in absolute coordinates they would drown it.
template <class F>
struct QuadricOf {
  F a00{}, a01{}, a02{}, a11{}, a12{}, a22{};
  F b0{}, b1{}, b2{};
  F c{};

  F trace() const { return a00 + a11 + a22; }

  Vec3<F> b() const { return {b0, b1, b2}; }

  Vec3<F> times(Vec3<F> x) const {
    return {a00 * x.x + a01 * x.y + a02 * x.z, a01 * x.x + a11 * x.y + a12 * x.z, a02 * x.x + a12 * x.y + a22 * x.z};
  }

  F value(Vec3<F> x) const { return c + dot(b() + b() + times(x), x); }
};

using Quadric = QuadricOf<float>;

template <class F>
inline QuadricOf<F> operator+(const QuadricOf<F>& p, const QuadricOf<F>& q) {
  return {p.a00 + q.a00, p.a01 + q.a01, p.a02 + q.a02, p.a11 + q.a11, p.a12 + q.a12,
          p.a22 + q.a22, p.b0 + q.b0,   p.b1 + q.b1,   p.b2 + q.b2,   p.c + q.c};
}

/// The same function in a frame in which q's origin lies at `origin`.
template <class F>
inline QuadricOf<F> seen_from(const QuadricOf<F>& q, Vec3<F> origin) {
  const Vec3<F> e = q.times(origin);
  QuadricOf<F> r = q;
  r.b0 = q.b0 - e.x;
  r.b1 = q.b1 - e.y;
  r.b2 = q.b2 - e.z;
  r.c = q.c + dot(e - (q.b() + q.b()), origin);
  return r;
}

/// A and b of p, a share of them replaced by q's; the error c, which has been made already, stays whole.
inline Quadric blend(const Quadric& p, const Quadric& q, float share) {
  const float kept = 1 - share;
  return {kept * p.a00 + share * q.a00, kept * p.a01 + share * q.a01,
          kept * p.a02 + share * q.a02, kept * p.a11 + share * q.a11,
          kept * p.a12 + share * q.a12, kept * p.a22 + share * q.a22,
          kept * p.b0 + share * q.b0,   kept * p.b1 + share * q.b1,
          kept * p.b2 + share * q.b2,   p.c};
}

/// Adds weight * (normal . x)^2, the plane through the origin with that normal (of any length).
template <class F>
inline void add_plane(QuadricOf<F>& q, Vec3<F> normal, F weight) {
  const Vec3<F> w = normal * weight;
  q.a00 += w.x * normal.x;
  q.a01 += w.x * normal.y;
  q.a02 += w.x * normal.z;
  q.a11 += w.y * normal.y;
  q.a12 += w.y * normal.z;
  q.a22 += w.z * normal.z;
}

/// The matrices of four quadrics without b and c, added up.
inline Quadric sum_of_planes(const QuadricOf<Float4>& q) {
  Quadric r;
  r.a00 = sum(q.a00);
  r.a01 = sum(q.a01);
  r.a02 = sum(q.a02);
  r.a11 = sum(q.a11);
  r.a12 = sum(q.a12);
  r.a22 = sum(q.a22);
  return r;
}

}  // namespace geosis
