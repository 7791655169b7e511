#pragma once

#include "engine/base/progress.h"
#include "engine/missing/bit_lines.h"
#include "engine/missing/node_set.h"

namespace geosis {

/// Drops the nodes whose nearest valid sample is more than `limit` steps away: Euclid's distance, every axis counted in
/// nodes. Exact: squares of integers are compared. When cancelled, some are left.
///
/// nodes   one line a trace, i * crosslines + j
/// limit   above zero
/// cost    O(nodes) if all have a valid sample within the limit on one of their axes, else three passes over every
///         layer of samples where one has not. Memory: 8 bytes a trace and thread.
void drop_beyond(double limit, const NodeSet& valid, BitLines& nodes, int threads, const Progress& progress);

}  // namespace geosis
