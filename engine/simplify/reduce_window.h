#pragma once

#include "engine/simplify/rules.h"
#include "engine/simplify/watch.h"
#include "engine/simplify/window_state.h"

namespace geosis {

/// Collapses edges until the goal is reached or no edge can collapse. False if cancelled.
///
/// Compiled for several instruction sets, of which the machine's best is taken: the same bytes with each.
bool reduce_window(WindowState& window, const Goal& goal, const Rules& rules, Watch& watch);

}  // namespace geosis
