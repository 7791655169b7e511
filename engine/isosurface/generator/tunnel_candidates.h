#pragma once

#include <vector>

#include "engine/isosurface/generator/cell_patches.h"
#include "engine/isosurface/generator/cell_states.h"
#include "engine/isosurface/mc33_tables.h"
#include "engine/isosurface/patch_geometry.h"

namespace geosis::generator {

/// One way to fill a state with a tunnel: discs, and an annulus between the two loops that the tunnel joins.
struct TunnelCandidate {
  CellPatch triangles;
  Mc33TunnelPatch inner;  ///< where the vertex inside lies; its patch field is not set
};

/// Whether the candidate cuts itself; with a vertex inside, on either sheet.
bool cuts_itself(const TunnelCandidate& candidate, const CellPoints& points);

/// Few patches, one of which does not cut itself in each of the geometries: greedily those that serve most, and only
/// for geometries that none of these serves, patches with a vertex inside. Empty when the state cannot be filled.
std::vector<TunnelCandidate> choose_candidates(const CellState& state, const StateWitnesses& witnesses,
                                               const std::vector<CellPoints>& geometries);

}  // namespace geosis::generator
