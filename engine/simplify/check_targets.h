#pragma once

#include <vector>

#include "engine/base/result.h"
#include "engine/simplify/build_lods.h"

namespace geosis {

/// errors   invalid_argument: no target, one that is not exactly one of ratio, max_error and max_cost or out of range,
///          or one that is not coarser than an earlier one of its kind.
Result<void> check_targets(const BuildLodsOptions& options);

}  // namespace geosis
