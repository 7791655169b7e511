#include "engine/mesh/lattice_triangles.h"

#include <algorithm>
#include <cstdlib>

namespace geosis {
namespace {

// Determinants of differences below 2^25 need 77 bits; below 2^20, as nearly always, 64 bits hold them.
__extension__ using Wide = __int128;
constexpr std::int64_t kNarrow = std::int64_t{1} << 19;

template <class Int>
Vec3<Int> widened(LatticePoint p) {
  return {p.x, p.y, p.z};
}

template <class Int>
int sign_of(Int x) {
  return x > 0 ? 1 : x < 0 ? -1 : 0;
}

/// Exact predicates on one number type that holds all its determinants.
template <class Int>
struct Predicates {
  using Point = Vec3<Int>;
  using Corners = std::array<Point, 3>;

  /// Side of d on the plane through a, b and c.
  static int side(Point a, Point b, Point c, Point d) { return sign_of(dot(cross(b - a, c - a), d - a)); }

  /// Turn of a, b, c in the plane without `axis`.
  static int turn(Point a, Point b, Point c, int axis) { return sign_of(cross(b - a, c - a)[axis]); }

  static int dominant_axis(const Corners& t) {
    const Point n = cross(t[1] - t[0], t[2] - t[0]);
    const auto size = [&](int axis) { return n[axis] < 0 ? -n[axis] : n[axis]; };
    return size(0) >= size(1) && size(0) >= size(2) ? 0 : size(1) >= size(2) ? 1 : 2;
  }

  static bool has_area(const Corners& t) { return !(cross(t[1] - t[0], t[2] - t[0]) == Point{}); }

  /// Whether r, on the line through p and q, lies between them.
  static bool is_between(Point p, Point q, Point r) { return dot(p - r, q - r) <= 0; }

  static bool coplanar_segments_meet(Point p, Point q, Point a, Point b, int axis) {
    const int pa = turn(p, q, a, axis), pb = turn(p, q, b, axis);
    const int ap = turn(a, b, p, axis), aq = turn(a, b, q, axis);
    if (pa * pb < 0 && ap * aq < 0) return true;
    return (pa == 0 && is_between(p, q, a)) || (pb == 0 && is_between(p, q, b)) || (ap == 0 && is_between(a, b, p)) ||
           (aq == 0 && is_between(a, b, q));
  }

  static bool coplanar_segment_meets(Point p, Point q, const Corners& t) {
    const int axis = dominant_axis(t);
    bool left = false, right = false;
    for (int n = 0; n < 3; ++n) {
      if (coplanar_segments_meet(p, q, t[n], t[(n + 1) % 3], axis)) return true;
      const int turned = turn(t[n], t[(n + 1) % 3], p, axis);
      left = left || turned > 0;
      right = right || turned < 0;
    }
    return !(left && right);  // p inside, and q with it
  }

  static bool segment_meets(Point p, Point q, const Corners& t) {
    const int side_p = side(t[0], t[1], t[2], p), side_q = side(t[0], t[1], t[2], q);
    if (side_p * side_q > 0) return false;
    if (side_p == 0 && side_q == 0) return coplanar_segment_meets(p, q, t);
    const int u = side(p, q, t[0], t[1]), v = side(p, q, t[1], t[2]), w = side(p, q, t[2], t[0]);
    return (u >= 0 && v >= 0 && w >= 0) || (u <= 0 && v <= 0 && w <= 0);
  }

  /// Triangles without a common corner.
  static bool apart_intersect(const Corners& s, const Corners& t) {
    for (int n = 0; n < 3; ++n) {
      if (segment_meets(s[n], s[(n + 1) % 3], t) || segment_meets(t[n], t[(n + 1) % 3], s)) return true;
    }
    return false;
  }

  /// Triangles with one common corner, the first of both: what they share beyond it reaches an opposite side.
  static bool fan_intersects(const Corners& s, const Corners& t) {
    return segment_meets(s[1], s[2], t) || segment_meets(t[1], t[2], s);
  }

  /// Triangles with a common side, their first two corners: folded flat onto each other.
  static bool wedge_intersects(const Corners& s, const Corners& t) {
    if (side(s[0], s[1], s[2], t[2]) != 0) return false;
    const int axis = dominant_axis(s);
    return turn(s[0], s[1], s[2], axis) == turn(s[0], s[1], t[2], axis);
  }

  /// The first `shared` corners of both are the same.
  static bool intersect(const LatticeTriangle& s, const LatticeTriangle& t, int shared) {
    const Corners p = {widened<Int>(s[0]), widened<Int>(s[1]), widened<Int>(s[2])};
    const Corners q = {widened<Int>(t[0]), widened<Int>(t[1]), widened<Int>(t[2])};
    if (!has_area(p) || !has_area(q)) return false;
    switch (shared) {
      case 0:
        return apart_intersect(p, q);
      case 1:
        return fan_intersects(p, q);
      case 2:
        return wedge_intersects(p, q);
      default:
        return true;
    }
  }
};

/// Moves the corners that both triangles have to the front of both, in the same order; returns their number.
int align_shared_corners(LatticeTriangle& s, LatticeTriangle& t) {
  int shared = 0;
  for (int n = 0; n < 3; ++n) {
    const auto twin = std::find(t.begin() + shared, t.end(), s[n]);
    if (twin == t.end()) continue;
    std::iter_swap(t.begin() + shared, twin);
    std::swap(s[shared++], s[n]);
  }
  return shared;
}

}  // namespace

bool triangles_intersect(const LatticeTriangle& s, const LatticeTriangle& t) {
  const LatticePoint origin = s[0];
  LatticeTriangle p = s, q = t;
  std::int64_t extent = 0;
  for (int n = 0; n < 3; ++n) {
    p[n] = p[n] - origin;
    q[n] = q[n] - origin;
    for (int axis = 0; axis < 3; ++axis) extent = std::max({extent, std::abs(p[n][axis]), std::abs(q[n][axis])});
  }
  const int shared = align_shared_corners(p, q);
  return extent < kNarrow ? Predicates<std::int64_t>::intersect(p, q, shared)
                          : Predicates<Wide>::intersect(p, q, shared);
}

}  // namespace geosis
