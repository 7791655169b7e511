#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/structure/dip_field.h"
#include "engine/structure/layer_depths.h"

namespace geosis {

/// The traces in the order in which layers are carried to them: from the reference trace, the one with data that is
/// nearest to the survey's middle, along the links that agree best.
struct PaintOrder {
  std::vector<std::int32_t> trace;  ///< every one once, [0] the reference
  std::vector<float> link_cost[2];  ///< of each trace's link on each axis: 0.02 where all agrees, up to 1.02
};

/// cost     O(traces log traces), and one look at the agreements.
/// source   E. W. Dijkstra 1959.
PaintOrder order_traces(const DipField& field, int threads);

/// Carries layers from the reference trace to all others along the dips: each trace takes the mean of what its
/// neighbours that have them say, weighted by 1 / cost squared.
///
/// depths   shape, layers, spacing and first set; the rest is written.
/// errors   cancelled.
/// cost     about 30 ns a node.
Result<void> paint_layers(const DipField& field, const PaintOrder& order, const Progress& progress,
                          LayerDepths& depths);

}  // namespace geosis
