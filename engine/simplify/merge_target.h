#pragma once

#include "engine/simplify/working_vertex.h"

namespace geosis {

/// An edge whose one end lies on the boundary collapses onto that end; others go where the quadric is least.
enum class MergeTarget { best, at_u, at_v };

inline MergeTarget merge_target(const WorkingVertex& u, const WorkingVertex& v) {
  if (u.on_boundary == v.on_boundary) return MergeTarget::best;
  return u.on_boundary ? MergeTarget::at_u : MergeTarget::at_v;
}

}  // namespace geosis
