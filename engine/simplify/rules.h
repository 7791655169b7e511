#pragma once

#include <cstdint>
#include <limits>

#include "engine/simplify/placement.h"

namespace geosis {

/// Which edge collapses next.
enum class Strategy {
  greedy,           ///< the cheapest of the window
  multiple_choice,  ///< the cheapest of 8 random ones
};

/// How edges are chosen and merged; the same for all levels.
struct Rules {
  Strategy strategy = Strategy::greedy;
  Placement placement = Placement::optimal;
  std::uint64_t seed = 0;
};

/// How far to go.
struct Goal {
  std::int64_t triangles = 0;                                ///< to leave
  float max_cost = std::numeric_limits<float>::infinity();   ///< of a collapse
  float max_error = std::numeric_limits<float>::infinity();  ///< of a collapse, in voxels; estimated
  bool refuse_folds = true;                                  ///< see folds_over
  bool is_followed = false;                                  ///< by other passes, which see again what this one skips
};

}  // namespace geosis
