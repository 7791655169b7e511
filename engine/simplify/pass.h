#pragma once

#include <cstdint>

#include "engine/simplify/watch.h"
#include "engine/simplify/working_mesh.h"

namespace geosis {

struct PassOptions {
  std::int64_t target = 0;       ///< triangles to leave, if the windows can; met to within a few
  std::int32_t window_size = 0;  ///< vertices
  std::uint32_t number = 0;      ///< of the pass, for the place of the windows
  bool last = false;             ///< of a level: windows may give whatever the target asks of them
  int threads = 1;
};

/// Cuts the mesh into windows, simplifies each by itself and joins them again, in the windows' order. False if
/// cancelled; the mesh is then of no use.
bool run_pass(WorkingMesh& mesh, const PassOptions& options, Watch& watch);

}  // namespace geosis
