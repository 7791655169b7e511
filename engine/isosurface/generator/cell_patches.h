#pragma once

#include <array>
#include <string>
#include <vector>

#include "engine/isosurface/generator/cell_states.h"

namespace geosis::generator {

using PatchTriangle = std::array<int, 3>;  ///< cell edges

/// The triangles that fill a state's loops: a disc each, and an annulus between the two that a tunnel joins.
using CellPatch = std::vector<PatchTriangle>;

/// The triangulation with the fewest self-intersections, then the least area, over the witnesses, among those that draw
/// no forbidden chord: none that lies in
/// a face and belongs to the neighbour's half (chord::allowed) or repeats a segment of a loop.
CellPatch fill_loops(const CellState& state, const StateWitnesses& witnesses);

/// What is wrong with a patch; empty when it is an oriented manifold with exactly the loops as boundary, the Euler
/// characteristic of its discs and annulus, and no forbidden chord.
std::string find_fault(const CellState& state, const CellPatch& patch);

/// Witnesses in which two triangles of the patch cut each other (edges crossing at exact linear positions).
int count_self_intersections(const StateWitnesses& witnesses, const CellPatch& patch);

}  // namespace geosis::generator
