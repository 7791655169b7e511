#pragma once

#include "engine/base/progress.h"
#include "engine/missing/gaps/bit_lines.h"
#include "engine/volume/grid.h"

namespace geosis {

/// Drops the nodes whose nearest valid sample is more than `limit` steps away: Euclid's distance, every axis counted in
/// nodes. Exact: squares of integers are compared. When cancelled, some are left.
///
/// nodes, valid   one line a trace, i * crosslines + j
/// limit          above zero
/// cost           three passes over every layer of samples that has a node without a valid sample within the limit on
///                its own lines; cheap otherwise. Memory: 8 bytes a trace and thread.
void drop_beyond(double limit, GridShape shape, const BitLines& valid, BitLines& nodes, int threads,
                 const Progress& progress);

}  // namespace geosis
