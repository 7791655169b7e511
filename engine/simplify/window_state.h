#pragma once

#include <cstdint>
#include <vector>

#include "engine/simplify/bucket_queue.h"
#include "engine/simplify/merged_star.h"
#include "engine/simplify/rings.h"
#include "engine/simplify/working_mesh.h"

namespace geosis {

/// What a window holds between its steps; see window.h.
struct WindowState {
  std::vector<WorkingVertex> vertices;
  std::vector<std::uint16_t> version;  ///< raised when an edge cost at the vertex is out of date
  Rings rings;
  BucketQueue queue;
  VertexMarks marks;
  Box bounds;
  bool queued = false;  ///< whether the queue has ever been filled
  std::int64_t triangles = 0;
  float max_cost = 0;   ///< of the collapses since load
  bool capped = false;  ///< whether the last goal's max_cost or max_error refused a collapse
};

}  // namespace geosis
