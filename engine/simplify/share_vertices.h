#pragma once

#include <cstddef>

#include "engine/mesh/lod_hierarchy.h"

namespace geosis {

/// Renumbers the vertices of all levels so that each level's positions are the first of every level that has more.
///
/// hierarchy   every vertex of a level is one of M0 (its origin), in place, and on every level that has more vertices;
///             an empty origin means that each vertex is its own.
/// m0_vertices how many M0 has.
void share_vertices(LodHierarchy& hierarchy, std::size_t m0_vertices);

}  // namespace geosis
