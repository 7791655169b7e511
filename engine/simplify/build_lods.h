#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/mesh/indexed_mesh.h"
#include "engine/mesh/lod_hierarchy.h"
#include "engine/simplify/rules.h"

namespace geosis {

/// Which small closed components to take out of a level; those that satisfy one of the two go, except the largest.
struct DropSpecks {
  double max_voxels = 0;  ///< enclosed volume on M0, of bodies and cavities alike
  double max_error =
      0;  ///< half the diagonal of the bounding box on M0, in voxels: how far any point is from its middle

  bool any() const { return max_voxels > 0 || max_error > 0; }
};

/// How coarse a level is: exactly one of ratio, max_error and max_cost.
struct LevelTarget {
  std::optional<double> ratio = std::nullopt;      ///< of M0's triangles, in (0, 1]
  std::optional<double> max_error = std::nullopt;  ///< as coarse as this distance to M0 allows, in voxels
  std::optional<double> max_cost = std::nullopt;   ///< as coarse as collapses up to this quadric cost make it
  /// Collapses that would take the surface farther from M0 than this are refused (in voxels; an estimate, the root mean
  /// square over the planes a vertex stands for). Unset = default_error_cap for a ratio; infinity = none.
  std::optional<double> error_cap = std::nullopt;
  DropSpecks drop = {};  ///< for this level and the coarser ones
};

/// One level a ratio.
std::vector<LevelTarget> by_ratio(const std::vector<double>& ratios);

/// Whether the first of these levels is M0 itself.
bool begins_with_m0(const std::vector<LevelTarget>& levels);

/// The cap of a level of that ratio for which none is given, in voxels.
double default_error_cap(double ratio);

/// Measures how far a level is from M0, in voxels, both ways.
using MeasureError = std::function<double(const IndexedMesh& m0, const IndexedMesh& level)>;

struct BuildLodsOptions {
  std::vector<LevelTarget> levels = by_ratio({1, 0.25, 0.0625, 0.015625, 0.00390625});  ///< each coarser than the last
  Strategy strategy = Strategy::greedy;
  Placement placement = Placement::optimal;
  std::uint64_t seed = 0;  ///< of multiple_choice
  int threads = 1;
  MeasureError measure = {};  ///< needed for levels by max_error
};

/// The levels of detail M0 ... Mn, level 0 finest; each continues from the one before.
///
/// m0       manifold with or without boundary, oriented, vertices on the lattice (as extract_body makes it).
/// returns  one level per target, with the topology of m0 without the dropped components: Euler characteristic,
///          components, genus of each component, boundary loops, orientation. Vertices stay on the 1/64 lattice. A
///          level that cannot be reached stops at its floor or its error cap and says so. Each vertex knows the one of
///          m0 it descends from. With Placement::subset a level's positions are the first of every level that has
///          more: all share one array, for which M0's vertices are put in another order. The same bytes for any number
///          of threads.
/// errors   invalid_argument: targets that are out of range, not coarser one by one, or ambiguous; an m0 that is no
///          manifold or off the lattice.  cancelled.
/// source   Garland & Heckbert 1997 (quadrics); Lindstrom & Turk 1998 (volume); the link condition of Dey et al. 1999;
///          Tavares et al., Table 1 (multiple choice).
Result<LodHierarchy> build_lods(IndexedMesh m0, const BuildLodsOptions& options, Progress& progress);

/// Takes level `number` as soon as it is made. A first level that is M0 itself comes at once, with an empty mesh.
using TakeLevel = std::function<void(std::size_t number, LodLevel level)>;

/// build_lods for callers that go on with a level while the next one is made. Levels come in order, finest first, on
/// the caller's thread.
///
/// errors   those of build_lods; levels that were taken before are sound, unless m0 is no manifold.  unsupported:
///          Placement::subset, whose vertices have their numbers when the last level is there.
Result<void> build_lods_one_by_one(const IndexedMesh& m0, const BuildLodsOptions& options, Progress& progress,
                                   const TakeLevel& take);

}  // namespace geosis
