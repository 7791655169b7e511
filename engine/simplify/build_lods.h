#pragma once

#include <span>
#include <vector>

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/mesh/indexed_mesh.h"
#include "engine/mesh/lod_hierarchy.h"

namespace geosis {

struct BuildLodsOptions {
  std::vector<double> ratios = {1, 0.25, 0.0625, 0.015625, 0.00390625};  ///< of M0's triangles, falling, each in (0, 1]
  int threads = 1;
};

/// The levels of detail M0 ... Mn, level 0 finest; each continues from the one before.
///
/// m0       manifold with or without boundary, oriented, vertices on the lattice (as extract_body makes it).
/// returns  one level per ratio, with the topology of m0: Euler characteristic, components, genus of each component,
///          boundary loops, orientation. Vertices stay on the 1/64 lattice. A level that cannot be reached stops at
///          its floor and says so. Each vertex knows the one of m0 it descends from. The same bytes for any number of
///          threads.
/// errors   invalid_argument: ratios not falling or not in (0, 1].  cancelled.
/// source   Garland & Heckbert 1997 (quadrics); the link condition of Dey et al. 1999.
Result<LodHierarchy> build_lods(IndexedMesh m0, const BuildLodsOptions& options, Progress& progress);

}  // namespace geosis
