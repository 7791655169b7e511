#include "engine/simplify/merged_star.h"

namespace geosis {
namespace {

bool holds(RingTriangle t, LocalVertex v) {
  return t.a == v || t.b == v;
}

/// How many vertices are next to both u and v where one of them lies on the boundary.
int count_common(LocalVertex u, bool u_open, LocalVertex v, bool v_open, const Rings& rings, VertexMarks& marks) {
  marks.clear();
  int common = 0;
  for (const LocalVertex w : neighbours_of(u, u_open, rings)) marks.set(w);
  for (const LocalVertex w : neighbours_of(v, v_open, rings)) common += marks.has(w);
  return common;
}

}  // namespace

bool find_merged_star(LocalVertex u, LocalVertex v, std::span<const WorkingVertex> vertices, const Rings& rings,
                      VertexMarks& marks, MergedStar& star) {
  if (rings.degree(u) + rings.degree(v) > kMaxMergedDegree + 4) return false;
  marks.clear();
  int degree = 0;
  int shared = 0;
  for (const RingTriangle t : rings.of(u)) {
    marks.set(t.a);
    star.ring[degree] = t;
    if (!holds(t, v)) {
      ++degree;
    } else {
      if (shared == 2) return false;
      star.opposite[shared++] = t.a == v ? t.b : t.a;
    }
  }
  if (shared == 0) return false;
  star.from_u = degree;
  int common = 0;
  for (const RingTriangle t : rings.of(v)) {
    common += marks.has(t.a);
    star.ring[degree] = t;
    degree += !holds(t, u);
  }
  if (degree == 0 || degree > kMaxMergedDegree) return false;
  star.degree = degree;
  star.shared = shared;

  const bool u_open = vertices[u].on_boundary;
  const bool v_open = vertices[v].on_boundary;
  if (u_open || v_open) {
    if (u_open && v_open && shared == 2) return false;
    return count_common(u, u_open, v, v_open, rings, marks) == shared;
  }
  const bool tetrahedron = rings.degree(u) == 3 && rings.degree(v) == 3;
  return common == shared && !tetrahedron;
}

}  // namespace geosis
