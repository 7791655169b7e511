#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "engine/isosurface/cell.h"
#include "engine/isosurface/mc33_tables.h"
#include "engine/mesh/lattice_triangles.h"

namespace geosis {

/// Where a cell's vertices lie, in lattice steps from its corner 0: one on each crossed edge, and the one inside.
using CellPoints = std::array<LatticePoint, cell::kEdges + 1>;

/// Whether two triangles of a patch meet outside the corners and edges they share. corners   as in kMc33Corners.
bool patch_cuts_itself(std::span<const std::uint8_t> corners, const CellPoints& points);

/// The vertex inside the cell of a patch that splits a face's chord: beside the chord's middle, off the face.
///
/// sheet    0 or 1: points of the two sheets never coincide, their coordinates' sums are even and odd.
LatticePoint inner_point(const Mc33TunnelPatch& patch, const CellPoints& points, int sheet);

}  // namespace geosis
