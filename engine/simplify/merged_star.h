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
  /// First u's triangles, then v's; without those on both, which go.
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

/// The lattice point next to p that lies in the box (whose corners are lattice points).
inline Vec3f snap_to_lattice(Vec3f p, const Box& bounds) {
  const auto snap = [](float x, float low, float high) {
    constexpr float kSteps = static_cast<float>(kLatticeStepsPerVoxel);
    x = std::min(std::max(x, low), high);
    return static_cast<float>(static_cast<std::int32_t>(x * kSteps + (x < 0 ? -0.5f : 0.5f))) * kLatticeStep;
  };
  return {snap(p.x, bounds.low.x, bounds.high.x), snap(p.y, bounds.low.y, bounds.high.y),
          snap(p.z, bounds.low.z, bounds.high.z)};
}

}  // namespace geosis
