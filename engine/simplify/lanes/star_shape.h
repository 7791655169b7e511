// The triangles of a merged star, eight at a time; see lanes.h.
#if defined(GEOSIS_SIMPLIFY_LANES_STAR_SHAPE_H) == defined(HWY_TARGET_TOGGLE)
#ifdef GEOSIS_SIMPLIFY_LANES_STAR_SHAPE_H
#undef GEOSIS_SIMPLIFY_LANES_STAR_SHAPE_H
#else
#define GEOSIS_SIMPLIFY_LANES_STAR_SHAPE_H
#endif

#include "engine/simplify/lanes/quadric.h"
#include "engine/simplify/merged_star.h"

HWY_BEFORE_NAMESPACE();
namespace geosis {
namespace HWY_NAMESPACE {

inline constexpr float kFlipCosine2 = 0.04f;  // a triangle may turn by 78 degrees
inline constexpr float kThinSine2 =
    1e-7f;  // squared sine of a triangle's corner: well above float32's rounding of a product
inline constexpr float kOneWayCosine2 =
    0.06f;  // triangles up to 76 degrees off the direction of their star look one way
inline constexpr float kFarthestVolume2 = 0.25f;  // squared way to the plane of equal volume, in squared edge lengths

/// Most groups of eight triangles in a star.
inline constexpr int kStarGroups = (kMaxMergedDegree + kLanes - 1) / kLanes;

/// Eight vectors in memory, of which one can be had.
struct LaneRow {
  alignas(32) float x[kLanes], y[kLanes], z[kLanes];

  HWY_INLINE void set(V3<Float8> v) {
    std::memcpy(x, &v.x, sizeof(x));
    std::memcpy(y, &v.y, sizeof(y));
    std::memcpy(z, &v.z, sizeof(z));
  }
  HWY_INLINE V3<Float8> get() const {
    V3<Float8> v;
    std::memcpy(&v.x, x, sizeof(x));
    std::memcpy(&v.y, y, sizeof(y));
    std::memcpy(&v.z, z, sizeof(z));
    return v;
  }
  HWY_INLINE Vec3f at(int lane) const { return {x[lane], y[lane], z[lane]}; }
};
using LaneRows = LaneRow[kStarGroups];

/// The triangles of a merged star that stay, as they are.
struct StarShape {
  LaneRows a, side;   ///< of triangle (v, a, b): a, and b - a
  LaneRows normal;    ///< twice the triangle's area long
  Vec3f all_normals;  ///< sum over all triangles at u or v, if the star is closed
  float swept;        ///< six times the volume that v's triangles that stay sweep when v moves to u
};

/// The normals of a closed star sum up to the same vector wherever its vertex lies, so that the triangles that go need
/// not be looked at: those at v are summed up as if v were at u.
HWY_INLINE void measure_star(const MergedStar& star, LocalVertex u, LocalVertex v, const WorkingVertex* vertices,
                             StarShape& shape) {
  const V3<Float8> edge = all8(vertices[v].position - vertices[u].position);
  const V3<Float8> at_u = all8(vertices[u].position);
  const V3<Float8> at_v = all8(vertices[v].position);
  V3<Float8> all_normals{};
  Float8 swept{};
  for (int group = 0, first = 0; first < star.degree; ++group, first += kLanes) {
    const WorkingVertex *at_a[kLanes], *at_b[kLanes];
    for (int i = 0; i < kLanes; ++i) {
      const RingTriangle t = star.ring[first + i < star.degree ? first + i : star.degree - 1];
      at_a[i] = &vertices[t.a];
      at_b[i] = &vertices[t.b];
    }
    const V3<Float8> a = positions_of(at_a);
    const V3<Float8> side = positions_of(at_b) - a;
    const Mask8 inside = lanes_below(first, star.degree);
    const Mask8 from_v = inside & ~lanes_below(first, star.from_u);
    const V3<Float8> seen_from_u = cross(side, at_u - a);
    const V3<Float8> normal = select(from_v, cross(side, at_v - a), seen_from_u);
    all_normals = all_normals + select(inside, seen_from_u, V3<Float8>{});
    swept = swept + select(from_v, dot(normal, edge), Float8{});
    shape.a[group].set(a);
    shape.side[group].set(side);
    shape.normal[group].set(normal);
  }
  const Float4 sums = sums_of(all_normals.x, all_normals.y, all_normals.z, swept);
  shape.all_normals = {sums[0], sums[1], sums[2]};
  shape.swept = sums[3];
}

/// The place nearest to `place` for which the volume behind the merged star stays what it was; `place` itself if that
/// one is too far off. Both relative to u; `edge` from u to v.
///
/// When the vertex of triangle (w, a, b) moves from w to p, it sweeps a sixth of (p - w) . normal. Over the star that
/// is linear in p, so the places of equal volume are a plane, at right angles to the sum of the normals. source
/// Lindstrom & Turk 1998, volume preservation.
HWY_INLINE Vec3f keep_volume(const StarShape& shape, Vec3f edge, Vec3f place) {
  const float length2 = dot(shape.all_normals, shape.all_normals);
  const float missing = shape.swept - dot(shape.all_normals, place);
  if (!(length2 > 0) || missing * missing > kFarthestVolume2 * dot(edge, edge) * length2) return place;
  return place + shape.all_normals * (missing / length2);
}

/// The star's triangles once their vertex has moved.
struct MovedStar {
  bool sound = false;  ///< no triangle turned over or collapsed
  bool sharp = false;  ///< the triangles do not all look one way: they may fold over each other
  Quadric planes;      ///< of the moved triangles, in the frame of their common vertex
  LaneRows arm;        ///< of triangle (v, a, b): v - a
  LaneRows normal;     ///< twice the triangle's area long
};

/// closed   whether the star is: then its normals' sum does not change.
HWY_INLINE void move_star(const MergedStar& star, const StarShape& shape, Vec3f position, bool closed,
                          MovedStar& moved) {
  moved.sound = false;
  const V3<Float8> to = all8(position);
  Float8 length2[kStarGroups];
  LaneQuadric<Float8> planes;
  V3<Float8> direction{};
  for (int group = 0, first = 0; first < star.degree; ++group, first += kLanes) {
    const Mask8 inside = lanes_below(first, star.degree);
    const V3<Float8> arm = to - shape.a[group].get();
    const V3<Float8> side = shape.side[group].get();
    const V3<Float8> before = shape.normal[group].get();
    const V3<Float8> after = cross(side, arm);
    const Float8 cosine = dot(before, after);
    const Float8 after2 = dot(after, after);
    const Mask8 turned = (cosine <= Float8{}) | (cosine * cosine < dot(before, before) * after2 * kFlipCosine2);
    const Mask8 thin = after2 <= dot(side, side) * dot(arm, arm) * kThinSine2;
    if (any((turned | thin) & inside)) return;
    add_planes(planes, after, select(inside, 0.5f / (square_root(after2) + kTiny), Float8{}));
    if (!closed) direction = direction + select(inside, after, V3<Float8>{});
    moved.arm[group].set(arm);
    moved.normal[group].set(after);
    length2[group] = after2;
  }
  Vec3f sum = shape.all_normals;
  if (!closed) {
    const Float4 sums = sums_of(direction.x, direction.y, direction.z, Float8{});
    sum = {sums[0], sums[1], sums[2]};
  }
  const V3<Float8> one_way = all8(sum);
  const Float8 one_way2 = dot(one_way, one_way) * kOneWayCosine2;
  std::uint32_t off = 0;
  for (int group = 0, first = 0; first < star.degree; ++group, first += kLanes) {
    const Float8 cosine = dot(moved.normal[group].get(), one_way);
    off |= bits_of(lanes_below(first, star.degree) &
                   ((cosine <= Float8{}) | (cosine * cosine < one_way2 * length2[group])));
  }
  moved.sound = true;
  moved.sharp = off != 0;
  moved.planes = sum_of_planes(planes);
}

}  // namespace HWY_NAMESPACE
}  // namespace geosis
HWY_AFTER_NAMESPACE();

#endif
