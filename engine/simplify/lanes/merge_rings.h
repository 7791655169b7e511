// One-rings of two vertices that merge, eight triangles at a time; see lanes.h.
#if defined(GEOSIS_SIMPLIFY_LANES_MERGE_RINGS_H) == defined(HWY_TARGET_TOGGLE)
#ifdef GEOSIS_SIMPLIFY_LANES_MERGE_RINGS_H
#undef GEOSIS_SIMPLIFY_LANES_MERGE_RINGS_H
#else
#define GEOSIS_SIMPLIFY_LANES_MERGE_RINGS_H
#endif

#include <bit>

#include "engine/simplify/lanes/lanes.h"
#include "engine/simplify/merged_star.h"
#include "engine/simplify/window_state.h"

HWY_BEFORE_NAMESPACE();
namespace geosis {
namespace HWY_NAMESPACE {

/// A ring's triangle (v, a, b) as one number, a in the lower half.
HWY_INLINE std::int32_t packed(LocalVertex a, LocalVertex b) {
  return static_cast<std::int32_t>(std::uint32_t{a} | std::uint32_t{b} << 16);
}

HWY_INLINE Int8 load_triangles(const RingTriangle* ring) {
  static_assert(sizeof(RingTriangle) == sizeof(std::int32_t) && std::endian::native == std::endian::little);
  Int8 triangles;
  std::memcpy(&triangles, ring, sizeof(triangles));
  return triangles;
}

/// The lanes, up to `degree`, whose triangle has the vertex.
HWY_INLINE std::uint32_t lanes_with(Int8 triangles, LocalVertex v, int degree) {
  const Int8 low = all8(std::int32_t{0xffff}), high = ~low;
  const Mask8 has = ((triangles & low) == all8(packed(v, 0))) | ((triangles & high) == all8(packed(0, v)));
  return bits_of(has) & ((1u << degree) - 1);
}

/// How many of eight vertices `ring` lists as a (of triangle (v, a, b)) another ring lists so, too.
HWY_INLINE int count_common(Int8 ring, int degree, Int8 other, int other_degree) {
  const Int8 low = all8(std::int32_t{0xffff});
  const Int8 a = select(lanes_below(0, degree), ring & low, all8(std::int32_t{-1}));
  const Int8 b = select(lanes_below(0, other_degree), other & low, all8(std::int32_t{-2}));
  std::int32_t each[kLanes];
  std::memcpy(each, &b, sizeof(each));
  Mask8 found{};
  for (int i = 0; i < kLanes; ++i) found = found | (a == all8(each[i]));
  return std::popcount(bits_of(found));
}

/// As geosis::find_merged_star, which decides where this one does not: small rings inside the surface, nearly always.
HWY_INLINE bool find_merged_star(LocalVertex u, LocalVertex v, const WindowState& window, VertexMarks& marks,
                                 MergedStar& star) {
  const Rings& rings = window.rings;
  const int degree_u = rings.degree(u), degree_v = rings.degree(v);
  const auto& vertices = window.vertices;
  if (degree_u > kLanes || degree_v > kLanes || vertices[u].on_boundary || vertices[v].on_boundary)
    return geosis::find_merged_star(u, v, vertices, rings, marks, star);
  const RingTriangle *ring_u = rings.data(u), *ring_v = rings.data(v);
  const Int8 around_u = load_triangles(ring_u), around_v = load_triangles(ring_v);
  const std::uint32_t on_v = lanes_with(around_u, v, degree_u), on_u = lanes_with(around_v, u, degree_v);
  if (std::popcount(on_v) != 2 || std::popcount(on_u) != 2) return false;
  if (count_common(around_u, degree_u, around_v, degree_v) != 2 || degree_u + degree_v == 6) return false;
  // The two triangles on the edge give their places to the last ones.
  const auto keep = [](Int8 around, const RingTriangle* ring, int degree, std::uint32_t shared, RingTriangle* to)
                        HWY_ATTR {
                          std::memcpy(to, &around, sizeof(around));
                          const int first = std::countr_zero(shared), second = std::bit_width(shared) - 1;
                          to[second] = ring[degree - 1];
                          to[first] = second != degree - 2 ? ring[degree - 2] : ring[degree - 1];
                        };
  for (int i = 0; i < 2; ++i) {
    const RingTriangle t = ring_u[i == 0 ? std::countr_zero(on_v) : std::bit_width(on_v) - 1];
    star.opposite[i] = t.a == v ? t.b : t.a;
  }
  keep(around_u, ring_u, degree_u, on_v, star.ring.data());
  keep(around_v, ring_v, degree_v, on_u, star.ring.data() + degree_u - 2);
  star.from_u = degree_u - 2;
  star.degree = degree_u + degree_v - 4;
  star.shared = 2;
  return star.degree > 0;
}

/// Takes the triangle on u and v out of w's ring; it must be there.
HWY_INLINE void remove_triangle(Rings& rings, LocalVertex w, LocalVertex u, LocalVertex v) {
  RingTriangle* ring = rings.data(w);
  for (int first = 0;; first += kLanes) {
    const Int8 triangles = load_triangles(ring + first);
    const std::uint32_t found = bits_of((triangles == all8(packed(u, v))) | (triangles == all8(packed(v, u))));
    if (found == 0) continue;
    const int last = rings.degree(w) - 1;
    ring[first + std::countr_zero(found)] = ring[last];
    rings.shorten(w, last);
    return;
  }
}

/// Makes u out of every v in w's ring, and in what lies within eight triangles behind it: another ring has v only if
/// its vertex is next to v, and then it is renamed, too.
HWY_INLINE void rename(Rings& rings, LocalVertex w, LocalVertex v, LocalVertex u) {
  const Int8 low = all8(std::int32_t{0xffff}), high = ~low;
  RingTriangle* ring = rings.data(w);
  const int degree = rings.degree(w);
  for (int i = 0; i < degree; i += kLanes) {
    const Int8 triangles = load_triangles(ring + i);
    const Mask8 a = ((triangles & low) == all8(packed(v, 0))) & low;
    const Mask8 b = ((triangles & high) == all8(packed(0, v))) & high;
    const Int8 renamed = (triangles & ~(a | b)) | (all8(packed(u, u)) & (a | b));
    std::memcpy(ring + i, &renamed, sizeof(renamed));
  }
}

/// Merges v into u in all rings.
HWY_INLINE void merge_rings(Rings& rings, LocalVertex u, LocalVertex v, bool v_on_boundary, const MergedStar& star) {
  for (int i = 0; i < star.shared; ++i) remove_triangle(rings, star.opposite[i], u, v);
  for (const LocalVertex w : neighbours_of(v, v_on_boundary, rings)) {
    if (w != u) rename(rings, w, v, u);
  }
  rings.merge(u, v, star.triangles());
}

}  // namespace HWY_NAMESPACE
}  // namespace geosis
HWY_AFTER_NAMESPACE();

#endif
