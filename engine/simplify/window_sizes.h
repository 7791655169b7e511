#pragma once

#include <cstdint>

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/mesh/lod_hierarchy.h"
#include "engine/simplify/build_lods.h"

namespace geosis {

/// How many vertices are simplified at a time. The result depends on these, so they are not options of a request; tests
/// make them small, to see many windows on a small mesh.
struct WindowSizes {
  std::int32_t pass = 4'096;         ///< windows of a level's first passes: they stay in the fastest cache
  std::int32_t last_pass = 65'536;   ///< larger ones at its end: fewer vertices of the level were locked
  std::int32_t whole_mesh = 24'576;  ///< meshes up to this size are one window from the start
};

/// build_lods with windows of other sizes, each in 1 ... 65,536.
Result<LodHierarchy> build_lods_in_windows(IndexedMesh m0, const BuildLodsOptions& options, const WindowSizes& sizes,
                                           Progress& progress);

}  // namespace geosis
