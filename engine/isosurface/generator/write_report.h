#pragma once

#include <map>
#include <string>

#include "engine/isosurface/generator/proven_states.h"

namespace geosis::generator {

/// The text of docs/mc33-cases.md: what was proven of which subcase.
std::string report_text(const std::map<CellState, ProvenState>& states);

}  // namespace geosis::generator
