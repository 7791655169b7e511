#pragma once

#include <cstdint>

#include "engine/simplify/rules.h"
#include "engine/simplify/watch.h"
#include "engine/simplify/working_mesh.h"

namespace geosis {

struct PassOptions {
  Goal goal;  ///< its triangles are met to within a few, if the windows can
  Rules rules;
  std::int32_t window_size = 0;  ///< vertices
  std::uint32_t number = 0;      ///< of the pass, for the place of the windows
  bool last = false;             ///< of a level: windows may give whatever the goal asks of them
  int threads = 1;
};

enum class PassEnd { done, cancelled, not_manifold };

struct PassResult {
  PassEnd end = PassEnd::done;
  float max_cost = 0;   ///< largest of an accepted collapse
  bool capped = false;  ///< whether the goal's max_cost or max_error refused a collapse
};

/// Cuts the mesh into windows, simplifies each by itself and joins them again, in the windows' order. The first pass
/// also finds out whether M0 is a manifold. Unless done, the mesh is of no use.
PassResult run_pass(WorkingMesh& mesh, const PassOptions& options, Watch& watch);

}  // namespace geosis
