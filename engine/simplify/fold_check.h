#pragma once

#include <span>

#include "engine/simplify/collapse.h"
#include "engine/simplify/rings.h"
#include "engine/simplify/working_vertex.h"

namespace geosis {

/// Whether a star that moved its vertex to `position` would intersect itself or the triangles around it: those that
/// have a vertex with it in common. Exact, on the lattice. Nearly all pairs of triangles that simplification makes
/// intersect lie so close together: the ends of thin bodies fold, sheets hardly ever meet.
///
/// shape    of the star before the move.
bool folds_over(const MergedStar& star, const StarShape& shape, LocalVertex u, LocalVertex v, Vec3f position,
                std::span<const WorkingVertex> vertices, const Rings& rings, VertexMarks& marks);

}  // namespace geosis
