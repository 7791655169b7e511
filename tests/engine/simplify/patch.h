#pragma once

#include <cstddef>
#include <vector>

#include "engine/simplify/merged_star.h"

namespace geosis {

/// A piece of a mesh, for looking at stars.
struct Patch {
  std::vector<WorkingVertex> vertices;
  Rings rings;
  VertexMarks marks;
};

/// Boundary vertices are those named; all lie at the origin.
inline Patch make_patch(std::size_t vertices, const std::vector<LocalTriangle>& triangles,
                        const std::vector<LocalVertex>& boundary) {
  Patch p{std::vector<WorkingVertex>(vertices), {}, {}};
  p.rings.build(vertices, triangles);
  p.marks.reset(vertices);
  for (const LocalVertex v : boundary) p.vertices[v].on_boundary = true;
  return p;
}

}  // namespace geosis
