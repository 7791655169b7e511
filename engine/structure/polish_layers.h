#pragma once

#include <functional>

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/structure/dip_field.h"
#include "engine/structure/layer_depths.h"

namespace geosis {

/// Moves painted layers so that neighbouring traces differ by the dips between them, as well as all links allow at
/// once: least squares, links weighted by the eighth power of their agreement and less the further they are off (so
/// that faults let go), with a little resistance against uneven thickness. The reference trace stays.
///
/// depths   painted; rising before and after.
/// report   told fractions of the work.
/// errors   cancelled.
/// cost     4 rounds of 30 steps of conjugate gradients, each about 10 ns a node; 24 bytes a node beside the depths.
///          The same for any number of threads.
Result<void> polish_layers(const DipField& field, LayerDepths& depths, int threads, const Progress& progress,
                           const std::function<void(double)>& report);

}  // namespace geosis
