#pragma once

namespace geosis {

/// Where the vertex lies that an edge collapses to.
enum class Placement {
  optimal,  ///< where the quadric is least, moved so that the volume stays
  subset,   ///< at the cheaper end of the edge: every vertex of a level is one of M0
};

}  // namespace geosis
