#pragma once

#include <map>
#include <vector>

#include "engine/isosurface/generator/cell_states.h"
#include "engine/isosurface/generator/tunnel_candidates.h"

namespace geosis::generator {

/// Geometries of a state to choose patches by, and others to check them in: without a tunnel, with one.
inline constexpr int kToChoose[2] = {500, 12'000};
inline constexpr int kToCheck[2] = {1'000, 10'000};

/// A state with its patches, all of them proven: one, or with a tunnel several to choose from.
struct ProvenState {
  std::vector<TunnelCandidate> patches;
  int geometries = 0;    ///< others than those that the patches were chosen by
  int first_cuts = 0;    ///< of these, where the first patch cuts itself
  int inner_serves = 0;  ///< where only a patch with a vertex inside does not cut itself
  int all_cut = 0;       ///< where every patch cuts itself
};

/// Triangulates and proves every state that a trilinear function can take; ends the program at a fault.
std::map<CellState, ProvenState> prove_states();

}  // namespace geosis::generator
