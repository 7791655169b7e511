#pragma once

#include <cstddef>
#include <cstdint>

#include "engine/mesh/corner_table.h"

namespace geosis {

/// Operators that change a mesh locally and keep its topological type: Euler characteristic, components, genus,
/// boundary loops and orientation. Each works on the two arrays of a corner table and returns false, with the table as
/// it was, where it would change the type. Vertices that have gone are in no triangle any more; triangles that have
/// gone have kGone at their corners until remove_gone_triangles.
///
/// The table must be that of a manifold with or without boundary, and the corners given must not have gone.
/// cost     O(triangles around the vertices involved).
/// source   the link condition of Dey, Edelsbrunner, Guha & Nekhayev 1999; the set of operators of Tavares et al.

inline constexpr std::int32_t kGone = -1;

/// Turns the edge that c faces: it then runs from c's vertex to the one across. Refused on a boundary and where those
/// two vertices have an edge already.
bool flip_edge(CornerTable& table, std::int32_t c);

/// The vertex at previous(c) merges into the one at next(c); the one or two triangles on the edge that c faces go.
bool collapse_edge(CornerTable& table, std::int32_t c);

/// Takes out c's vertex, which must have split an edge: inside, four triangles become two, on a boundary two become
/// one. The edge is whole again from previous(c) on. Refused for vertices with other numbers of triangles.
bool weld_edge(CornerTable& table, std::int32_t c);

/// The three vertices of a triangle merge into that of its corner c; it goes, and the triangles on its edges.
bool collapse_face(CornerTable& table, std::int32_t c);

/// All vertices next to c's merge into it; the triangles around it go, and those across from them. Refused for a
/// vertex on the boundary.
bool collapse_star(CornerTable& table, std::int32_t c);

/// Whether merging the ends of the edge that c faces keeps the topological type.
bool has_link_condition(const CornerTable& table, std::int32_t c);

/// The table without what has gone: triangles move together, in their order.
CornerTable remove_gone_triangles(const CornerTable& table);

}  // namespace geosis
