#pragma once

#include "engine/base/vec3.h"

namespace geosis {

/// The function x'Ax + 2b'x + c: a sum of squared distances to planes, each weighted by an area.
///
/// Every vertex keeps its quadric in its own frame, with the vertex at the origin. There b and c are as small as the
/// error itself, so float32 does at any coordinate; in absolute coordinates they would drown it.
struct Quadric {
  float a00 = 0, a01 = 0, a02 = 0, a11 = 0, a12 = 0, a22 = 0;
  float b0 = 0, b1 = 0, b2 = 0;
  float c = 0;

  float trace() const { return a00 + a11 + a22; }

  Vec3f times(Vec3f x) const {
    return {a00 * x.x + a01 * x.y + a02 * x.z, a01 * x.x + a11 * x.y + a12 * x.z, a02 * x.x + a12 * x.y + a22 * x.z};
  }

  float value(Vec3f x) const { return c + dot(Vec3f{b0, b1, b2} * 2.0f + times(x), x); }
};

inline Quadric operator+(const Quadric& p, const Quadric& q) {
  return {p.a00 + q.a00, p.a01 + q.a01, p.a02 + q.a02, p.a11 + q.a11, p.a12 + q.a12,
          p.a22 + q.a22, p.b0 + q.b0,   p.b1 + q.b1,   p.b2 + q.b2,   p.c + q.c};
}

/// The same function in a frame in which q's origin lies at `origin`.
inline Quadric seen_from(const Quadric& q, Vec3f origin) {
  const Vec3f e = q.times(origin);
  Quadric r = q;
  r.b0 = q.b0 - e.x;
  r.b1 = q.b1 - e.y;
  r.b2 = q.b2 - e.z;
  r.c = q.c + dot(e - Vec3f{q.b0, q.b1, q.b2} * 2.0f, origin);
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
inline void add_plane(Quadric& q, Vec3f normal, float weight) {
  const Vec3f w = normal * weight;
  q.a00 += w.x * normal.x;
  q.a01 += w.x * normal.y;
  q.a02 += w.x * normal.z;
  q.a11 += w.y * normal.y;
  q.a12 += w.y * normal.z;
  q.a22 += w.z * normal.z;
}

}  // namespace geosis
