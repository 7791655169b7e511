#pragma once

#include "engine/structure/dip_field.h"
#include "engine/structure/layer_depths.h"
#include "tests/support/layered_truth.h"

namespace geosis::test {

struct LayerErrors {
  double rms = 0;         ///< samples: of layers inside a block, from the true layer that fits best
  double neighbours = 0;  ///< share of neighbouring traces that are within half a sample, across faults too
};

/// How well layers of real depths follow the true ones, where they are not near top and bottom.
LayerErrors layer_errors(const LayeredTruth& truth, const LayerDepths& depths);

/// The plain grid's, as layers of real depths.
LayerDepths axis_depths(GridShape shape);

/// Root mean square error of all links' dips within blocks, away from top and bottom.
double dip_error(const LayeredTruth& truth, const DipField& field);

}  // namespace geosis::test
