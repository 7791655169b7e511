#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/simplify/rings.h"
#include "engine/simplify/working_mesh.h"

namespace geosis {

/// Most triangles around a merged vertex. Vertices that have more than kMaxDegree cannot merge at all.
inline constexpr int kMaxMergedDegree = 24;
inline constexpr int kMaxDegree = kMaxMergedDegree + 3;

/// Some vertices next to a vertex, each once.
struct Neighbours {
  std::array<LocalVertex, kMaxDegree + 1> ids;
  int count = 0;

  const LocalVertex* begin() const { return ids.data(); }
  const LocalVertex* end() const { return ids.data() + count; }
};

/// Those of v's neighbours that `wanted` holds for; v must have at most kMaxDegree triangles.
template <class Wanted>
inline Neighbours neighbours_of(LocalVertex v, bool on_boundary, const Rings& rings, const Wanted& wanted) {
  const auto ring = rings.of(v);
  Neighbours result;
  const auto add = [&](LocalVertex w) {
    result.ids[result.count] = w;
    result.count += wanted(w);
  };
  for (const RingTriangle t : ring) add(t.a);
  if (!on_boundary) return result;
  // An open fan: the last of its vertices is nobody's a.
  for (const RingTriangle t : ring) {
    const bool known = std::any_of(ring.begin(), ring.end(), [&](RingTriangle other) { return other.a == t.b; });
    if (!known) add(t.b);
  }
  return result;
}

inline Neighbours neighbours_of(LocalVertex v, bool on_boundary, const Rings& rings) {
  return neighbours_of(v, on_boundary, rings, [](LocalVertex) { return true; });
}

/// The star of the vertex that u and v would merge into.
struct MergedStar {
  /// First u's triangles, then v's, last those on both, which go.
  std::array<RingTriangle, 2 * kMaxDegree> ring;
  int degree = 0;                       ///< how many stay
  int from_u = 0;                       ///< how many of those are u's
  int shared = 0;                       ///< how many go: 2 inside the surface, 1 on its boundary
  std::array<LocalVertex, 2> opposite;  ///< third vertices of those

  std::span<const RingTriangle> triangles() const { return {ring.data(), static_cast<std::size_t>(degree)}; }
};

/// Marks of a set of vertices that can be emptied in no time.
class VertexMarks {
 public:
  void reset(std::size_t vertices) {
    mark_.assign(vertices, 0);
    current_ = 0;
  }
  void clear() {
    if (++current_ != 0) return;
    std::fill(mark_.begin(), mark_.end(), std::uint16_t{0});
    current_ = 1;
  }
  void set(LocalVertex v) { mark_[v] = current_; }
  bool has(LocalVertex v) const { return mark_[v] == current_; }

 private:
  std::vector<std::uint16_t> mark_;
  std::uint16_t current_ = 0;
};

/// Fills `star`; false if merging u and v would change the topology, or if too many triangles would meet.
///
/// The link condition: the only vertices next to both u and v are those opposite to their edge. With boundaries each
/// boundary loop counts as closed by one more vertex, so an inner edge between two boundary vertices never collapses.
/// A closed component keeps four triangles, a boundary loop three edges.
/// source   Dey, Edelsbrunner, Guha & Nekhayev 1999, theorem for 2-complexes with boundary.
bool find_merged_star(LocalVertex u, LocalVertex v, std::span<const WorkingVertex> vertices, const Rings& rings,
                      VertexMarks& marks, MergedStar& star);

/// The triangles of a merged star as they are, four side by side.
struct StarShape {
  static constexpr int kGroups = (kMaxMergedDegree + 2 + kLanes - 1) / kLanes;
  struct Row {
    Float4 x, y, z;
    void operator=(Vec3<Float4> v) { x = v.x, y = v.y, z = v.z; }
    operator Vec3<Float4>() const { return {x, y, z}; }
  };
  std::array<Row, kGroups> a, side;  ///< of triangle (v, a, b): a, and b - a
  std::array<Row, kGroups> normal;   ///< twice the triangle's area long
  Vec3f all_normals;                 ///< sum over all triangles at u or v
  Vec3f normals_of_v;                ///< sum over those at v and not at u
};

void measure_star(const MergedStar& star, LocalVertex u, LocalVertex v, std::span<const WorkingVertex> vertices,
                  StarShape& shape);

/// The place nearest to `place` for which the volume behind the merged star stays what it was; `place` itself if that
/// one is too far off. Both relative to u; `edge` from u to v.
/// source   Lindstrom & Turk 1998, volume preservation.
Vec3f keep_volume(const StarShape& shape, Vec3f edge, Vec3f place);

/// What is left of the star's triangles once their vertex has moved.
struct MovedStar {
  bool sound = false;  ///< no triangle turned over or collapsed
  bool sharp = false;  ///< the triangles do not all look one way: they may fold over each other
  Quadric planes;      ///< of the moved triangles, in the frame of their common vertex
};

MovedStar move_star(const MergedStar& star, const StarShape& shape, Vec3f position);

/// The lattice point next to p that lies in the box (whose corners are lattice points).
Vec3f snap_to_lattice(Vec3f p, const Box& bounds);

}  // namespace geosis
