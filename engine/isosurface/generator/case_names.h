#pragma once

#include <string>
#include <vector>

#include "engine/isosurface/generator/cell_states.h"

namespace geosis::generator {

/// The subcases of Chernyaev's numbering, in its order: 0, 1, 2, 3.1, 3.2, 4.1.1, ... 14.
const std::vector<std::string>& subcase_names();

/// The subcase of a state. Rarer corners count as marked: above the level where that is true of four or fewer.
///
/// Two choices are ours, because mirror images have different names: 11 is the path of marked corners whose three edges
/// form a right-handed frame, 14 the left-handed one; 12.2 and 12.3 differ by which ambiguous face joins the corners
/// above, seen from the single marked corner.
/// source   Chernyaev 1995, "Marching Cubes 33".
std::string subcase_of(const CellState& state);

}  // namespace geosis::generator
