#pragma once

#include <map>
#include <string>

#include "engine/isosurface/generator/proven_states.h"

namespace geosis::generator {

/// The text of engine/isosurface/mc33_tables.cpp.
std::string tables_text(const std::map<CellState, ProvenState>& states);

}  // namespace geosis::generator
