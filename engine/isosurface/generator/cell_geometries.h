#pragma once

#include <cstdint>
#include <vector>

#include "engine/isosurface/generator/cell_states.h"
#include "engine/isosurface/patch_geometry.h"

namespace geosis::generator {

/// Different ways in which the crossings of a state lie on the lattice, as the mesher rounds and clamps them: a seeded
/// walk from witness to witness through functions that take the state. Fewer than asked where the state has fewer.
std::vector<CellPoints> sample_geometries(const CellState& state, const StateWitnesses& witnesses, int count,
                                          std::uint64_t seed);

}  // namespace geosis::generator
