#pragma once

#include <span>

#include "engine/simplify/placement.h"
#include "engine/simplify/rings.h"
#include "engine/simplify/working_vertex.h"

namespace geosis {

/// An edge whose one end lies on the boundary collapses onto that end; others go where the quadric is least.
enum class MergeTarget { best, at_u, at_v };

inline MergeTarget merge_target(const WorkingVertex& u, const WorkingVertex& v) {
  if (u.on_boundary == v.on_boundary) return MergeTarget::best;
  return u.on_boundary ? MergeTarget::at_u : MergeTarget::at_v;
}

/// Where u and v should merge, relative to u: the point of least cost of their summed quadric (given in u's frame), or
/// with Placement::subset the cheaper of the two ends.
///
/// edge     from u to v. The point is pulled a little towards the edge's midpoint, which gives flat and straight
///          regions, where A is singular, a solution; one that lies too far off is replaced by the midpoint.
Vec3f best_point(const Quadric& sum, Vec3f edge, MergeTarget target, Placement placement = Placement::optimal);

/// What to queue the edges from u to each of its neighbours with: the merged quadric's value at its best point, plus a
/// little of the edge's length, so that flat regions have an order too.
///
/// costs    room for neighbours.size() rounded up to a multiple of kLanes.
void edge_costs(std::span<const WorkingVertex> vertices, LocalVertex u, std::span<const LocalVertex> neighbours,
                std::span<float> costs, Placement placement = Placement::optimal);

}  // namespace geosis
