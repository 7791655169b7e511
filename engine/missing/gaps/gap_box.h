#pragma once

#include <cstdint>
#include <vector>

#include "engine/volume/sample_box.h"

namespace geosis {

/// What a filling method may do with a node of its box.
enum class NodeState : std::uint8_t {
  absent,  ///< no value and none wanted: outside the survey's outline or the volume
  known,   ///< a measured sample, or one that is filled already: fixed
  wanted,  ///< missing, to be filled
};

/// A gap with the samples around it, as the filling methods see it. On entry wanted nodes hold the value to start from
/// (never NaN), on return the filled value.
struct GapBox {
  SampleBox samples;
  std::vector<NodeState> state;  ///< as samples.value
  bool wide = false;             ///< has the surroundings of a wide gap (gap_jobs.h)
};

}  // namespace geosis
