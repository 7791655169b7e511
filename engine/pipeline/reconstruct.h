#pragma once

#include <array>
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
#include "engine/isosurface/select_bodies.h"
#include "engine/mesh/lod_hierarchy.h"
#include "engine/mesh/vertex_attributes.h"
#include "engine/missing/file/filled_volume.h"
#include "engine/missing/fill_options.h"
#include "engine/simplify/build_lods.h"
#include "engine/structure/structural_grid.h"
#include "engine/volume/bricks.h"
#include "engine/volume/curvilinear_geometry.h"
#include "engine/volume/geometry.h"
#include "engine/volume/grid.h"

namespace geosis {

/// Raised only when output bytes change; part of every extraction id.
inline constexpr int kResultVersion = 3;

/// Which values the vertices of every level carry. Reliability is left out where every sample was measured, agreement
/// where the grid is not structural.
struct AttributeChoice {
  bool reliability = true, body = false, value = false, agreement = false;

  bool operator==(const AttributeChoice&) const = default;
};

/// Which bodies to keep: those that hold a seed, of these the ones with enough volume, of these the largest.
struct BodyChoice {
  std::vector<GridIndex> seeds = {};  ///< nodes; none = any body
  double min_voxels = 0;
  std::optional<std::uint32_t> largest = std::nullopt;

  bool keeps_all() const { return seeds.empty() && min_voxels <= 0 && !largest; }
  BodyFilter filter() const { return {.seeded = !seeds.empty(), .min_voxels = min_voxels, .largest = largest}; }
};

/// How samples of neighbouring traces are connected.
enum class GridChoice {
  given,       ///< those of equal index
  structural,  ///< those on one reflector, on a grid found from the samples
  automatic,   ///< structural where reflectors are steep enough for it to pay
  curvilinear  ///< those of equal index, whose nodes lie where somebody has put them
};

/// The request's part that the engine computes from; documents/ turns JSON into it.
struct ReconstructOptions {
  IsoRange range{};
  BodyMode mode = BodyMode::exact;
  bool cap = true;
  FillOptions fill = {};  ///< of missing samples, before anything else
  GridChoice grid = GridChoice::given;
  std::optional<std::string> grid_id = std::nullopt;  ///< of the curvilinear grid
  std::optional<GridBox> region = std::nullopt;       ///< unset = the whole volume
  BodyChoice bodies = BodyChoice();
  std::vector<LevelTarget> levels = by_ratio({1, 0.25, 0.0625, 0.015625, 0.00390625});
  Strategy strategy = Strategy::greedy;
  Placement placement = Placement::optimal;
  std::uint64_t seed = 0;                         ///< of multiple_choice
  bool index_space = false;                       ///< `space`: "index" instead of "world"
  std::optional<double> velocity = std::nullopt;  ///< m/s: turns two-way time in ms into depth in m
  AttributeChoice attributes = {};
  std::optional<std::string> attribute_volume = std::nullopt;  ///< id of the volume that `value` is of
  std::optional<int> position_bits = std::nullopt;             ///< unset = chosen so that topology survives
  std::optional<int> speed = std::nullopt;                     ///< unset = 7
  bool normals = false;                                        ///< at the vertices, from the field's gradient
  bool preview = false;  ///< of every few samples, without a promise of topology: preview.h
  int threads = 1;       ///< of each stage; levels are encoded beside their simplification by spare threads
};

/// Two-sided distance between surfaces in the units of a space.
struct SpaceDistance {
  double mean = 0, max = 0;
};

/// One level with all that its manifest entry says.
struct ReconstructedLevel {
  LevelTarget asked;
  LodLevel lod;
  VertexAttributes attributes;  ///< those asked for, of lod.mesh's vertices
  EncodedLevel encoded;
  TopologyReport topology;                      ///< of the decoded parts, joined
  SurfaceMeasures measures;                     ///< of the same, in the requested space
  SurfaceDistance distance;                     ///< to M0; all zero for a level that is M0 itself
  std::optional<SpaceDistance> space_distance;  ///< the same in the requested space, if that has lengths
  double volume_drift = 0;                      ///< (volume - volume of M0) / volume of M0; 0 when M0 has none
  double interpolated_share = 0;                ///< of the vertices: between samples of which one was filled
};

/// Which grid was chosen and why, where the choice was not the given one.
struct GridReport {
  DipReport dips;  ///< what `auto` decides by
  std::optional<StructureReport> structure =
      std::nullopt;         ///< of the structural grid; unset where samples stay connected as given
  std::int32_t layers = 0;  ///< of the structural grid
  std::optional<NodeReport> nodes = std::nullopt;  ///< of the curvilinear grid, which has nothing of the above
};

/// Why a reconstruction has no levels.
enum class EmptyReason {
  nothing_in_range,  ///< no body in the region
  no_surface,        ///< without cap: no border of a body in the region
  no_seeded_body,    ///< no body holds a seed
  too_small          ///< every body that could be kept has less than min_voxels
};

struct Reconstruction {
  std::vector<ReconstructedLevel> levels;  ///< level 0 = finest; empty when there is nothing to show
  /// From the levels' coordinates to the requested space, row-major. On a grid that is not affine a shift and a scale,
  /// which is a power of two: world positions in units of about a cell's edge.
  std::array<double, 16> transform = {};
  std::optional<GridReport> grid = {};    ///< unset when the given grid was asked for
  std::optional<EmptyReason> empty = {};  ///< set when there are no levels
};

/// Seconds of each stage on the caller's clock, for the caller's eyes only: never part of a result. Levels are encoded
/// and described by spare threads while finer and coarser ones are made: `encode` is what is left of that afterwards.
struct StageTimings {
  double grid = 0, fill = 0, extract = 0, simplify = 0, encode = 0, certify = 0;
};

/// Told of each level, coarsest first, as soon as it is encoded and its topology and measures are known; its distance
/// and volume drift are not yet. Called on the thread that called reconstruct.
using LevelSink = std::function<void(std::size_t level, const ReconstructedLevel&)>;

/// What a reconstruction reads. Everything is kept by reference.
struct ReconstructInput {
  const BrickedVolume& samples;  ///< as measured
  const GridGeometry& geometry;  ///< from index coordinates to the world
  bool has_lengths = true;       ///< the world's three axes have one unit: lengths, areas and volumes mean something
  const FilledVolume* filled = nullptr;  ///< samples with options.fill applied; null = filled here when asked for
  const StructuralGrid* grid = nullptr;  ///< the samples' structural grid; null = laid here when it is needed
  const DipReport* dips = nullptr;       ///< of the samples; null = found here when they are needed
  const BrickedVolume* attribute_volume = nullptr;  ///< of equal shape; what the attribute `value` is of
  const CurvilinearGeometry* nodes = nullptr;       ///< of equal shape; where the options' curvilinear grid lies

  const GridGeometry& grid_geometry() const {
    if (nodes != nullptr) return *nodes;
    return geometry;
  }
};

/// The whole way: volume -> grid -> filled volume -> M0 -> levels -> encoded parts -> certificate. The only place where
/// the order of stages is written down. The result is a pure function of input and options (threads excepted).
///
/// A structural grid is where the surface is extracted: its topology is that of the field which is trilinear in the
/// grid's cells. In world space the vertices then go to where the samples are, and simplification, distances and
/// volumes are of that mesh, in the coordinates (inline, crossline, sample); `space: index` stays on the rectified grid
/// (inline, crossline, layer). docs/structural-grid.md.
///
/// On a curvilinear grid the surface is extracted in index space too and its topology decided there; then its vertices
/// go where the nodes say. Bodies too small in cells are left out before, the largest are chosen by their volume in the
/// world. docs/grids.md.
///
/// A preview is a reconstruction of every few samples.
///
/// errors     those of lay_structural_grid, fill_missing, extract_body, build_lods and encode_level.  invalid_argument:
///            position bits that cannot hold the volume, `value` or a curvilinear grid without what it needs, or with
///            one of another shape.  limit_exceeded: a surface too long for the lattice.  cancelled.
Result<Reconstruction> reconstruct(const ReconstructInput& input, const ReconstructOptions& options, Progress& progress,
                                   StageTimings* timings = nullptr, const LevelSink& on_level = {});

}  // namespace geosis
