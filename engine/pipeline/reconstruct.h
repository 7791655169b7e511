#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "engine/analysis/surface_distance.h"
#include "engine/analysis/surface_measures.h"
#include "engine/analysis/topology_report.h"
#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/codec/level_codec.h"
#include "engine/isosurface/extract.h"
#include "engine/mesh/lod_hierarchy.h"
#include "engine/simplify/build_lods.h"
#include "engine/volume/bricks.h"
#include "engine/volume/geometry.h"

namespace geosis {

/// Raised only when output bytes change; part of every extraction id.
inline constexpr int kResultVersion = 2;

/// The request's part that the engine computes from; documents/ turns JSON into it.
struct ReconstructOptions {
  IsoRange range;
  BodyMode mode = BodyMode::exact;
  bool cap = true;
  std::optional<GridBox> region = std::nullopt;  ///< unset = the whole volume
  std::vector<double> ratios = {1, 0.25, 0.0625, 0.015625, 0.00390625};
  bool index_space = false;                         ///< `space`: "index" instead of "world"
  std::optional<int> position_bits = std::nullopt;  ///< unset = chosen so that topology survives
  std::optional<int> speed = std::nullopt;          ///< unset = 7
  int threads = 1;
};

/// One level with all that its manifest entry says.
struct ReconstructedLevel {
  LodLevel lod;
  EncodedLevel encoded;
  TopologyReport topology;   ///< of the decoded parts, joined
  SurfaceMeasures measures;  ///< of the same, in the requested space
  SurfaceDistance distance;  ///< to M0; all zero for a level that is M0 itself
  double volume_drift = 0;   ///< (volume - volume of M0) / volume of M0; 0 when M0 has none
};

struct Reconstruction {
  std::vector<ReconstructedLevel> levels;  ///< level 0 = finest; empty when nothing is in the range
};

/// Seconds of each stage, for the caller's eyes only: never part of a result.
struct StageTimings {
  double extract = 0, simplify = 0, encode = 0, certify = 0;
};

/// Told of each level, coarsest first, as soon as it is encoded and its topology and measures are known; its distance
/// and volume drift are not yet. Called on the thread that called reconstruct.
using LevelSink = std::function<void(std::size_t level, const ReconstructedLevel&)>;

/// The whole way: volume -> M0 -> levels -> encoded parts -> certificate. The only place where the order of stages is
/// written down. The result is a pure function of volume, geometry and options (threads excepted).
///
/// geometry   of the volume; the requested space is the world that it maps to, or the index space itself.
/// errors     those of extract_body, build_lods and encode_level.  invalid_argument: position bits that cannot hold the
///            volume.  unsupported: world space of a geometry that is not affine.  cancelled.
Result<Reconstruction> reconstruct(const BrickedVolume& volume, const GridGeometry& geometry,
                                   const ReconstructOptions& options, Progress& progress,
                                   StageTimings* timings = nullptr, const LevelSink& on_level = {});

}  // namespace geosis
