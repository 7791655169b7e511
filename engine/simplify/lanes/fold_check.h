// Whether a star folds over; see lanes.h.
#if defined(GEOSIS_SIMPLIFY_LANES_FOLD_CHECK_H) == defined(HWY_TARGET_TOGGLE)
#ifdef GEOSIS_SIMPLIFY_LANES_FOLD_CHECK_H
#undef GEOSIS_SIMPLIFY_LANES_FOLD_CHECK_H
#else
#define GEOSIS_SIMPLIFY_LANES_FOLD_CHECK_H
#endif

#include <bit>

#include "engine/mesh/indexed_mesh.h"
#include "engine/mesh/lattice_triangles.h"
#include "engine/simplify/lanes/star_shape.h"

HWY_BEFORE_NAMESPACE();
namespace geosis {
namespace HWY_NAMESPACE {

/// Whether a star that moved its vertex to `position` intersects itself or the triangles around it: those that have a
/// vertex with it in common. Nearly all pairs of triangles that simplification makes intersect lie so close together:
/// the ends of thin bodies fold, sheets hardly ever meet.
///
/// Exact: float32 says which pairs are apart, because all of one triangle lies strictly on one side of the other, but
/// for the corners they share; the few pairs that are left are decided on the lattice.
class FoldCheck {
 public:
  FoldCheck(const MergedStar& star, const MovedStar& moved, const StarShape& shape, Vec3f position, bool closed,
            const WorkingVertex* vertices)
      : star_(star),
        moved_(moved),
        position_(position),
        closed_(closed),
        vertices_(vertices),
        all_((1u << star.degree) - 1) {
    Float8 farthest{};
    for (int group = 0, first = 0; first < star.degree; ++group, first += kLanes) {
      std::int32_t at_a[kLanes], at_b[kLanes];
      for (int i = 0; i < kLanes; ++i) {
        const RingTriangle t = star.ring[first + i < star.degree ? first + i : star.degree - 1];
        at_a[i] = t.a;
        at_b[i] = t.b;
      }
      std::memcpy(&id_a_[group], at_a, sizeof(at_a));
      std::memcpy(&id_b_[group], at_b, sizeof(at_b));
      const V3<Float8> a = V3<Float8>{} - moved.arm[group].get();
      const V3<Float8> b = a + shape.side[group].get();
      a_[group].set(a);
      b_[group].set(b);
      farthest = larger(farthest, larger(extent(a), extent(b)));
    }
    is_exact_ = !any(all8(kExactExtent) < farthest);
  }

  bool meets_itself() const {
    std::uint32_t near[kMaxMergedDegree];
    for (int i = 0; i < star_.degree; ++i) {
      const V3<Float8> normal = all8(moved_.normal[i / kLanes].at(i % kLanes));
      Sides a, b;
      std::uint32_t next = 0, before = 0;  // the triangles on the other side of the edges from the star's vertex
      for (int group = 0, first = 0; first < star_.degree; ++group, first += kLanes) {
        a.add(normal, a_[group].get(), first);
        b.add(normal, b_[group].get(), first);
        next |= bits_of(id_a_[group] == all8(std::int32_t{star_.ring[i].b})) << first;
        before |= bits_of(id_b_[group] == all8(std::int32_t{star_.ring[i].a})) << first;
      }
      if (!is_exact_) a = b = {};
      // Two triangles on one edge meet beyond it only where they lie in one plane.
      const std::uint32_t apart =
          (a.above & b.above) | (a.below & b.below) | (next & (b.above | b.below)) | (before & (a.above | a.below));
      near[i] = all_ & ~apart & ~(1u << i);
    }
    for (int i = 0; i < star_.degree; ++i) {
      for (std::uint32_t others = near[i] >> i >> 1 << i << 1; others != 0; others &= others - 1) {
        const int k = std::countr_zero(others);
        if ((near[k] >> i & 1) != 0 && triangles_intersect(triangle(i), triangle(k))) return true;
      }
    }
    return false;
  }

  /// Whether it meets the triangle of these vertices, none of which is the star's own.
  bool meets(const LocalVertex (&t)[3]) const {
    Vec3f corner[3];
    for (int k = 0; k < 3; ++k) corner[k] = vertices_[t[k]].position - position_;
    std::uint32_t near = all_;
    if (is_exact_ && extent(corner[1] - corner[0]) < kExactExtent && extent(corner[2] - corner[0]) < kExactExtent) {
      near = near_triangles(t, corner);
    }
    for (; near != 0; near &= near - 1) {
      const LatticeTriangle other{on_lattice(corner[0]), on_lattice(corner[1]), on_lattice(corner[2])};
      if (triangles_intersect(triangle(std::countr_zero(near)), other)) return true;
    }
    return false;
  }

 private:
  /// Voxels. Triangles up to this size have normals that float32 holds exactly: products of 2^11 steps.
  static constexpr float kExactExtent = 16;
  static constexpr float kRounding = 1e-6f;  // several times that of a dot product

  static HWY_INLINE Float8 larger(Float8 a, Float8 b) { return select(a < b, b, a); }
  static HWY_INLINE Float8 extent(V3<Float8> v) {
    return larger(larger(magnitude(v.x), magnitude(v.y)), magnitude(v.z));
  }
  static HWY_INLINE float extent(Vec3f v) {
    const float x = std::abs(v.x), y = std::abs(v.y), z = std::abs(v.z);
    return x > y ? (x > z ? x : z) : (y > z ? y : z);
  }

  /// Which points lie strictly above and below planes, a bit each.
  struct Sides {
    std::uint32_t above = 0, below = 0;

    /// Of eight planes through the origin, or one, eight points, or one.
    HWY_INLINE void add(V3<Float8> normal, V3<Float8> point, int first) {
      const Float8 x = normal.x * point.x, y = normal.y * point.y, z = normal.z * point.z;
      const Float8 side = x + y + z;
      const Float8 unsure = (magnitude(x) + magnitude(y) + magnitude(z)) * kRounding;
      above |= bits_of(unsure < side) << first;
      below |= bits_of(side < -unsure) << first;
    }
  };

  /// Those of the star's triangles that neither lie on one side of the other triangle's plane nor have it on one side
  /// of theirs, but for the corners that both have.
  std::uint32_t near_triangles(const LocalVertex (&t)[3], const Vec3f (&corner)[3]) const {
    const V3<Float8> normal = all8(cross(corner[1] - corner[0], corner[2] - corner[0])), origin = all8(corner[0]);
    const Int8 id0 = all8(std::int32_t{t[0]}), id1 = all8(std::int32_t{t[1]}), id2 = all8(std::int32_t{t[2]});
    Sides a, b, centre;
    std::uint32_t shared_a = 0, shared_b = 0;
    centre.add(normal, V3<Float8>{} - origin, 0);
    for (int group = 0, first = 0; first < star_.degree; ++group, first += kLanes) {
      a.add(normal, a_[group].get() - origin, first);
      shared_a |= bits_of((id_a_[group] == id0) | (id_a_[group] == id1) | (id_a_[group] == id2)) << first;
    }
    const bool above = centre.above != 0, below = centre.below != 0;
    const std::uint32_t a_apart = (above ? a.above | shared_a : 0) | (below ? a.below | shared_a : 0);
    if (closed_ && (a_apart & all_) == all_) return 0;  // each of a closed star's vertices is an a once
    for (int group = 0, first = 0; first < star_.degree; ++group, first += kLanes) {
      b.add(normal, b_[group].get() - origin, first);
      shared_b |= bits_of((id_b_[group] == id0) | (id_b_[group] == id1) | (id_b_[group] == id2)) << first;
    }
    std::uint32_t near = all_ & ~(a_apart & ((above ? b.above | shared_b : 0) | (below ? b.below | shared_b : 0)));
    if (near != 0) near &= across_planes(t, corner);
    return near == 0 ? 0 : within_edges(near, t, corner);
  }

  /// Those of the star's triangles on whose plane the other triangle's own corners are not strictly on one side.
  std::uint32_t across_planes(const LocalVertex (&t)[3], const Vec3f (&corner)[3]) const {
    std::uint32_t above = all_, below = all_;
    for (int k = 0; k < 3; ++k) {
      Sides sides;
      std::uint32_t shared = 0;
      for (int group = 0, first = 0; first < star_.degree; ++group, first += kLanes) {
        sides.add(moved_.normal[group].get(), all8(corner[k]), first);
        const Int8 id = all8(std::int32_t{t[k]});
        shared |= bits_of((id_a_[group] == id) | (id_b_[group] == id)) << first;
      }
      above &= sides.above | shared;
      below &= sides.below | shared;
    }
    return all_ & ~(above | below);
  }

  /// Those of `near` that have not all of the other triangle beyond one of their edges: beyond the plane on that edge,
  /// at a right angle to the triangle.
  std::uint32_t within_edges(std::uint32_t near, const LocalVertex (&t)[3], const Vec3f (&corner)[3]) const {
    for (int group = 0, first = 0; first < star_.degree; ++group, first += kLanes) {
      if ((near >> first & 0xff) == 0) continue;
      const V3<Float8> normal = moved_.normal[group].get(), a = a_[group].get(), b = b_[group].get();
      const EdgePlanes to_a(a, normal), outer(b - a, normal), from_b(V3<Float8>{} - b, normal);
      std::uint32_t beyond_a = ~0u, beyond_outer = ~0u, beyond_b = ~0u;
      for (int k = 0; k < 3; ++k) {
        const Int8 id = all8(std::int32_t{t[k]});
        const Mask8 is_a = id_a_[group] == id, is_b = id_b_[group] == id;
        const V3<Float8> p = all8(corner[k]);
        beyond_a &= bits_of(is_a | to_a.has_beyond(p));
        beyond_outer &= bits_of(is_a | is_b | outer.has_beyond(p - a));
        beyond_b &= bits_of(is_b | from_b.has_beyond(p));
      }
      near &= ~((beyond_a | beyond_outer | beyond_b) & 0xff) << first | ~(0xffu << first);
    }
    return near;
  }

  /// Planes on the edges of eight counter-clockwise triangles, at right angles to those.
  struct EdgePlanes {
    V3<Float8> out;    ///< points away from the triangle
    V3<Float8> bound;  ///< of the terms it was made of: for its rounding

    HWY_INLINE EdgePlanes(V3<Float8> edge, V3<Float8> normal) {
      set(edge.y * normal.z, edge.z * normal.y, out.x, bound.x);
      set(edge.z * normal.x, edge.x * normal.z, out.y, bound.y);
      set(edge.x * normal.y, edge.y * normal.x, out.z, bound.z);
    }
    static HWY_INLINE void set(Float8 p, Float8 q, Float8& out, Float8& bound) {
      out = p - q;
      bound = magnitude(p) + magnitude(q);
    }
    /// p   from a point of the edge.
    HWY_INLINE Mask8 has_beyond(V3<Float8> p) const {
      const V3<Float8> size{magnitude(p.x), magnitude(p.y), magnitude(p.z)};
      return dot(bound, size) * kRounding < dot(out, p);
    }
  };

  static LatticePoint on_lattice(Vec3f p) {
    const auto steps = [](float x) { return static_cast<std::int64_t>(x * static_cast<float>(kLatticeStepsPerVoxel)); };
    return {steps(p.x), steps(p.y), steps(p.z)};
  }
  LatticeTriangle triangle(int i) const {
    return {LatticePoint{}, on_lattice(a_[i / kLanes].at(i % kLanes)), on_lattice(b_[i / kLanes].at(i % kLanes))};
  }

  const MergedStar& star_;
  const MovedStar& moved_;
  const Vec3f position_;
  const bool closed_;
  const WorkingVertex* vertices_;
  const std::uint32_t all_;
  bool is_exact_ = false;
  LaneRows a_, b_;  // the triangles' corners, from the star's vertex
  Int8 id_a_[kStarGroups], id_b_[kStarGroups];
};

/// Whether the star that u and v merge into folds over once its vertex lies at `position`.
inline bool folds_over(const MergedStar& star, const StarShape& shape, const MovedStar& moved, LocalVertex u,
                       LocalVertex v, Vec3f position, bool closed, const WorkingVertex* vertices, const Rings& rings,
                       VertexMarks& marks) {
  const FoldCheck check(star, moved, shape, position, closed, vertices);
  if (check.meets_itself()) return true;
  marks.clear();
  for (const auto [a, b] : star.triangles()) {
    marks.set(a);
    marks.set(b);
  }
  for (const RingTriangle in_star : star.triangles()) {
    const LocalVertex w = in_star.a;
    for (const auto [a, b] : rings.of(w)) {
      if (a == u || b == u || a == v || b == v) continue;
      if ((marks.has(a) && a < w) || (marks.has(b) && b < w)) continue;  // seen from that one
      if (check.meets({w, a, b})) return true;
    }
  }
  return false;
}

}  // namespace HWY_NAMESPACE
}  // namespace geosis
HWY_AFTER_NAMESPACE();

#endif
