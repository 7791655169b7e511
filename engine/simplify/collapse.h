#pragma once

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

/// The vertices around v, each once.
struct Neighbours {
  std::array<LocalVertex, kMaxDegree + 1> ids;
  int count = 0;

  const LocalVertex* begin() const { return ids.data(); }
  const LocalVertex* end() const { return ids.data() + count; }
};

/// v must have at most kMaxDegree triangles.
Neighbours neighbours_of(LocalVertex v, bool on_boundary, const Rings& rings);

/// The star of the vertex that u and v would merge into.
struct MergedStar {
  std::array<RingTriangle, 2 * kMaxDegree> ring;  ///< first u's triangles, then v's; without those on both
  int degree = 0;
  int from_u = 0;
  std::array<LocalVertex, 2> opposite;  ///< third vertices of the triangles on both
  int shared = 0;                       ///< how many of those: 2 inside the surface, 1 on its boundary

  std::span<const RingTriangle> triangles() const { return {ring.data(), static_cast<std::size_t>(degree)}; }
};

/// Marks of a set of vertices that can be emptied in no time.
class VertexMarks {
 public:
  void reset(std::size_t vertices);
  void clear();
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

/// What is left of the star's triangles once their vertex has moved.
struct MovedStar {
  bool sound = false;  ///< no triangle turned over or collapsed, no two vertices around in the same place
  Quadric planes;      ///< of the moved triangles, in the frame of their common vertex
};

MovedStar move_star(const MergedStar& star, LocalVertex u, LocalVertex v, Vec3f position,
                    std::span<const WorkingVertex> vertices);

/// The lattice point next to p that lies in the box (whose corners are lattice points).
Vec3f snap_to_lattice(Vec3f p, const Box& bounds);

}  // namespace geosis
