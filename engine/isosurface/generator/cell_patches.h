#pragma once

#include <array>
#include <string>
#include <vector>

#include "engine/isosurface/generator/cell_loops.h"
#include "engine/isosurface/generator/cell_states.h"

namespace geosis::generator {

using PatchTriangle = std::array<int, 3>;  ///< cell edges, or kInnerVertex
using CellPatch = std::vector<PatchTriangle>;

/// The two loops that the state's tunnel joins; {-1, -1} without one.
std::array<int, 2> tunnel_loops(const CellState& state, const StateWitnesses& witnesses, const CellLoops& loops);

/// The face in whose plane crossed edges a and b lie, with their places in its frame; face = -1 when there is none.
struct FaceChord {
  int face = -1, a = 0, b = 0;
};
FaceChord face_chord(int a, int b);

/// Whether the cell may join edges a and b inside: no segment of a loop, and no chord of a face that belongs to the
/// neighbour (chord::allowed).
bool chord_allowed(const CellState& state, const CellLoops& loops, int a, int b);

/// Sum of the triangles' areas over the witnesses (twice); none of them uses kInnerVertex.
double area_of(const StateWitnesses& witnesses, const CellPatch& patch);

/// A disc in every loop but those that a tunnel joins: the least area over the witnesses without a forbidden chord.
CellPatch fill_discs(const CellState& state, const StateWitnesses& witnesses);

/// What is wrong with a patch; empty when it is an oriented manifold with exactly the loops as boundary, the Euler
/// characteristic of its discs and annulus, and no forbidden chord.
std::string find_fault(const CellState& state, const CellPatch& patch);

}  // namespace geosis::generator
