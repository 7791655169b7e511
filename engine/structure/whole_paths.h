#pragma once

#include <cstdint>

#include "engine/base/result.h"
#include "engine/structure/layer_depths.h"
#include "engine/structure/layer_paths.h"

namespace geosis {

/// Paths of whole samples along layers of real depths: as many layers as it takes for hardly any trace to go on by more
/// than one sample from one to the next; one in twenty lags behind until it has caught up. Before the first
/// and behind the last, further layers run parallel to it until every trace has begun with its first sample and ended
/// with its last.
///
/// most_layers  the limit.
/// errors       limit_exceeded: it takes more layers than that.
/// cost         about 10 ns a node. The same for any number of threads.
Result<LayerPaths> whole_paths(const LayerDepths& depths, std::int32_t most_layers, int threads);

}  // namespace geosis
