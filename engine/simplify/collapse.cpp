#include "engine/simplify/collapse.h"

#include <cassert>
#include <cmath>

namespace geosis {
namespace {

constexpr float kFlipCosine2 = 0.04f;  // a triangle may turn by 78 degrees
constexpr float kThinSine2 = 1e-7f;  // squared sine of a triangle's corner: well above float32's rounding of a product
constexpr float kOneWayCosine2 = 0.06f;    // triangles up to 76 degrees off the direction of their star look one way
constexpr float kFarthestVolume2 = 0.25f;  // squared way to the plane of equal volume, in squared edge lengths

bool holds(RingTriangle t, LocalVertex v) {
  return t.a == v || t.b == v;
}

float to_lattice(float x) {
  constexpr float kSteps = static_cast<float>(kLatticeStepsPerVoxel);
  return static_cast<float>(static_cast<std::int32_t>(x * kSteps + (x < 0 ? -0.5f : 0.5f))) * kLatticeStep;
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
  std::array<RingTriangle, 2> both;
  for (const RingTriangle t : rings.of(u)) {
    marks.set(t.a);
    star.ring[degree] = t;
    if (!holds(t, v)) {
      ++degree;
    } else {
      if (shared == 2) return false;
      both[shared] = t;
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
  for (int i = 0; i < shared; ++i) star.ring[degree + i] = both[i];
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

void measure_star(const MergedStar& star, LocalVertex u, LocalVertex v, std::span<const WorkingVertex> vertices,
                  StarShape& shape) {
  const int all = star.degree + star.shared;
  const Vec3<Float4> at_u = all4(vertices[u].position);
  const Vec3<Float4> at_v = all4(vertices[v].position);
  Vec3<Float4> all_normals{}, normals_of_v{};
  for (int group = 0, first = 0; first < all; ++group, first += kLanes) {
    const auto triangle = [&](int i) { return star.ring[std::min(first + i, all - 1)]; };
    const RingTriangle t0 = triangle(0), t1 = triangle(1), t2 = triangle(2), t3 = triangle(3);
    const Vec3<Float4> a = positions_of(vertices[t0.a], vertices[t1.a], vertices[t2.a], vertices[t3.a]);
    const Vec3<Float4> b = positions_of(vertices[t0.b], vertices[t1.b], vertices[t2.b], vertices[t3.b]);
    const Mask4 from_v = lanes_below(first, star.degree) & ~lanes_below(first, star.from_u);
    const Vec3<Float4> side = b - a;
    const Vec3<Float4> normal = cross(side, select(from_v, at_v, at_u) - a);
    all_normals = all_normals + select(lanes_below(first, all), normal, {});
    normals_of_v = normals_of_v + select(from_v, normal, {});
    shape.a[group] = a;
    shape.side[group] = side;
    shape.normal[group] = normal;
  }
  shape.all_normals = sum(all_normals);
  shape.normals_of_v = sum(normals_of_v);
}

// When the vertex of triangle (w, a, b) moves from w to p, it sweeps a sixth of (p - w) . normal. Over the star that is
// linear in p, so the places of equal volume are a plane, at right angles to the sum of the normals.
Vec3f keep_volume(const StarShape& shape, Vec3f edge, Vec3f place) {
  const float length2 = dot(shape.all_normals, shape.all_normals);
  const float missing = dot(shape.normals_of_v, edge) - dot(shape.all_normals, place);
  if (!(length2 > 0) || missing * missing > kFarthestVolume2 * dot(edge, edge) * length2) return place;
  return place + shape.all_normals * (missing / length2);
}

MovedStar move_star(const MergedStar& star, const StarShape& shape, Vec3f position) {
  const Vec3<Float4> to = all4(position);
  std::array<StarShape::Row, StarShape::kGroups> normals;
  std::array<Float4, StarShape::kGroups> length2;
  QuadricOf<Float4> planes;
  Vec3<Float4> direction{};
  MovedStar moved;
  for (int group = 0, first = 0; first < star.degree; ++group, first += kLanes) {
    const Mask4 inside = lanes_below(first, star.degree);
    const Vec3<Float4> arm = to - shape.a[group];
    const Vec3<Float4> side = shape.side[group];
    const Vec3<Float4> before = shape.normal[group];
    const Vec3<Float4> after = cross(side, arm);
    const Float4 cosine = dot(before, after);
    const Float4 after2 = dot(after, after);
    const Mask4 turned = (cosine <= 0.0f) | (cosine * cosine < dot(before, before) * after2 * kFlipCosine2);
    const Mask4 thin = after2 <= dot(side, side) * dot(arm, arm) * kThinSine2;
    if (any((turned | thin) & inside)) return moved;
    Float4 length = after2;
    for (int i = 0; i < kLanes; ++i) length[i] = std::sqrt(after2[i]);
    add_plane(planes, after, select(inside, 0.5f / (length + 1e-20f), Float4{}));
    direction = direction + select(inside, after, {});
    normals[group] = after;
    length2[group] = after2;
  }
  const Vec3<Float4> one_way = all4(sum(direction));
  const Float4 one_way2 = dot(one_way, one_way) * kOneWayCosine2;
  Mask4 off{};
  for (int group = 0, first = 0; first < star.degree; ++group, first += kLanes) {
    const Float4 cosine = dot(Vec3<Float4>(normals[group]), one_way);
    off |= lanes_below(first, star.degree) & ((cosine <= 0.0f) | (cosine * cosine < one_way2 * length2[group]));
  }
  moved.sound = true;
  moved.sharp = any(off);
  moved.planes = sum_of_planes(planes);
  return moved;
}

Vec3f snap_to_lattice(Vec3f p, const Box& bounds) {
  for (int axis = 0; axis < 3; ++axis) p[axis] = to_lattice(std::clamp(p[axis], bounds.low[axis], bounds.high[axis]));
  return p;
}

}  // namespace geosis
