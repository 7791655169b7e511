#include "engine/simplify/collapse.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace geosis {
namespace {

constexpr float kFlipCosine2 = 0.04f;  // a triangle may turn by 78 degrees
constexpr float kThinSine2 = 1e-7f;  // squared sine of a triangle's corner: well above float32's rounding of a product

bool holds(RingTriangle t, LocalVertex v) {
  return t.a == v || t.b == v;
}

/// The star's triangles side by side: a and b stay, the third vertex goes from `from` to a common place.
constexpr std::size_t kLanes = 4;
constexpr std::size_t kRoom = (kMaxMergedDegree + kLanes) / kLanes * kLanes;
struct StarLanes {
  using Row = std::array<float, kRoom>;
  struct Points {
    Row x, y, z;
    void set(std::size_t i, Vec3f p) { x[i] = p.x, y[i] = p.y, z[i] = p.z; }
    Vec3f operator[](std::size_t i) const { return {x[i], y[i], z[i]}; }
  };
  alignas(16) Points a, b, from;
  alignas(16) Points normal;  // after the move
  alignas(16) Row weight;     // that makes the normal an area-weighted plane
  std::size_t used = 0;       // a multiple of kLanes; the last triangle fills it up
};

void gather(const MergedStar& star, LocalVertex u, LocalVertex v, std::span<const WorkingVertex> vertices,
            StarLanes& lanes) {
  const auto degree = static_cast<std::size_t>(star.degree);
  lanes.used = (degree + kLanes - 1) / kLanes * kLanes;
  for (std::size_t i = 0; i < lanes.used; ++i) {
    const std::size_t k = std::min(i, degree - 1);
    lanes.a.set(i, vertices[star.ring[k].a].position);
    lanes.b.set(i, vertices[star.ring[k].b].position);
    lanes.from.set(i, vertices[k < static_cast<std::size_t>(star.from_u) ? u : v].position);
  }
}

/// Moves the triangles first ... first + kLanes - 1; false if one turns too far or gets too thin. No branches: four
/// lanes are one vector.
bool move_triangles(StarLanes& lanes, std::size_t first, Vec3f position) {
  std::int32_t bad = 0;
  for (std::size_t i = first; i < first + kLanes; ++i) {
    const Vec3f a = lanes.a[i];
    const Vec3f side = lanes.b[i] - a;
    const Vec3f arm = position - a;
    const Vec3f before = cross(side, lanes.from[i] - a);
    const Vec3f after = cross(side, arm);
    const float cosine = dot(before, after);
    const float before2 = dot(before, before);
    const float after2 = dot(after, after);
    bad |= static_cast<std::int32_t>(cosine <= 0.0f);
    bad |= static_cast<std::int32_t>(cosine * cosine < kFlipCosine2 * before2 * after2);
    bad |= static_cast<std::int32_t>(after2 <= kThinSine2 * dot(side, side) * dot(arm, arm));
    lanes.normal.x[i] = after.x;
    lanes.normal.y[i] = after.y;
    lanes.normal.z[i] = after.z;
    lanes.weight[i] = 0.5f / (std::sqrt(after2) + 1e-20f);
  }
  return bad == 0;
}

/// Whether a vertex that only u had around it lies where one lies that only v had around it.
bool vertices_meet(const MergedStar& star, std::span<const WorkingVertex> vertices) {
  for (int i = 0; i < star.from_u; ++i) {
    const LocalVertex p = star.ring[i].a;
    for (int k = star.from_u; k < star.degree; ++k) {
      const LocalVertex q = star.ring[k].a;
      if (p != q && vertices[p].position == vertices[q].position) return true;
    }
  }
  return false;
}

float to_lattice(float x) {
  constexpr float kSteps = static_cast<float>(kLatticeStepsPerVoxel);
  return static_cast<float>(static_cast<std::int32_t>(x * kSteps + (x < 0 ? -0.5f : 0.5f))) * kLatticeStep;
}

}  // namespace

Neighbours neighbours_of(LocalVertex v, bool on_boundary, const Rings& rings) {
  const auto ring = rings.of(v);
  assert(ring.size() <= kMaxDegree);
  Neighbours result;
  for (const RingTriangle t : ring) result.ids[result.count++] = t.a;
  if (!on_boundary) return result;
  // An open fan: the last of its vertices is nobody's a.
  for (const RingTriangle t : ring) {
    const bool known = std::any_of(ring.begin(), ring.end(), [&](RingTriangle other) { return other.a == t.b; });
    if (!known) result.ids[result.count++] = t.b;
  }
  return result;
}

void VertexMarks::reset(std::size_t vertices) {
  mark_.assign(vertices, 0);
  current_ = 0;
}

void VertexMarks::clear() {
  if (++current_ != 0) return;
  std::fill(mark_.begin(), mark_.end(), std::uint16_t{0});
  current_ = 1;
}

bool find_merged_star(LocalVertex u, LocalVertex v, std::span<const WorkingVertex> vertices, const Rings& rings,
                      VertexMarks& marks, MergedStar& star) {
  if (rings.degree(u) + rings.degree(v) > kMaxMergedDegree + 4) return false;
  star.degree = star.shared = 0;
  for (const RingTriangle t : rings.of(u)) {
    if (!holds(t, v)) {
      star.ring[star.degree++] = t;
    } else {
      if (star.shared == 2) return false;
      star.opposite[star.shared++] = t.a == v ? t.b : t.a;
    }
  }
  if (star.shared == 0) return false;
  star.from_u = star.degree;
  for (const RingTriangle t : rings.of(v)) {
    if (!holds(t, u)) star.ring[star.degree++] = t;
  }
  if (star.degree == 0 || star.degree > kMaxMergedDegree) return false;

  const bool u_open = vertices[u].on_boundary;
  const bool v_open = vertices[v].on_boundary;
  if (u_open && v_open && star.shared == 2) return false;
  if (!u_open && !v_open && rings.degree(u) == 3 && rings.degree(v) == 3) return false;  // a tetrahedron
  marks.clear();
  for (const LocalVertex w : neighbours_of(u, u_open, rings)) marks.set(w);
  int common = 0;
  for (const LocalVertex w : neighbours_of(v, v_open, rings)) common += marks.has(w);
  return common == star.shared;
}

MovedStar move_star(const MergedStar& star, LocalVertex u, LocalVertex v, Vec3f position,
                    std::span<const WorkingVertex> vertices) {
  StarLanes lanes;
  gather(star, u, v, vertices, lanes);
  MovedStar moved;
  for (std::size_t first = 0; first < lanes.used; first += kLanes) {
    if (!move_triangles(lanes, first, position)) return moved;
  }
  if (vertices_meet(star, vertices)) return moved;
  for (int i = 0; i < star.degree; ++i) add_plane(moved.planes, lanes.normal[i], lanes.weight[i]);
  moved.sound = true;
  return moved;
}

Vec3f snap_to_lattice(Vec3f p, const Box& bounds) {
  for (int axis = 0; axis < 3; ++axis) p[axis] = to_lattice(std::clamp(p[axis], bounds.low[axis], bounds.high[axis]));
  return p;
}

}  // namespace geosis
