#include "engine/pipeline/reconstruct.h"

#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "engine/pipeline/certify.h"
#include "engine/pipeline/curved_space.h"
#include "engine/pipeline/finish_levels.h"
#include "engine/pipeline/grid_stage.h"
#include "engine/pipeline/level_attributes.h"
#include "engine/pipeline/output_space.h"
#include "engine/pipeline/preview.h"
#include "engine/pipeline/stages.h"

namespace geosis {
namespace {

/// Adds the seconds of its lifetime to a stage's timing.
class StageTimer {
 public:
  explicit StageTimer(double& seconds) : seconds_(seconds), start_(Clock::now()) {}
  ~StageTimer() { seconds_ += std::chrono::duration<double>(Clock::now() - start_).count(); }
  StageTimer(const StageTimer&) = delete;
  StageTimer& operator=(const StageTimer&) = delete;

 private:
  using Clock = std::chrono::steady_clock;
  double& seconds_;
  Clock::time_point start_;
};

template <class Stage>
auto timed(double& seconds, const Stage& stage) {
  const StageTimer timer(seconds);
  return stage();
}

/// What all stages of one reconstruction share.
struct Run {
  const ReconstructInput& input;
  const ReconstructOptions& options;
  AffineGeometry space;           ///< from the meshes' coordinates to the requested space
  std::span<const Vec3f> places;  ///< of M0's vertices among the samples, on a grid that is not affine
  const StructuralGrid* grid;     ///< null on the axis grid
  const LayerMap* layers;         ///< of the structural grid, cut to the region
  EncodeOptions encode;
  Progress& progress;
  StageTimings& timings;
  const LevelSink& on_level;

  /// The layers when meshes stay on the rectified grid.
  const LayerMap* rectified() const { return options.index_space ? layers : nullptr; }
  CertifyOptions certify() const { return {space, input.has_lengths, options.threads}; }
};

const Error kCancelled = {ErrorCode::cancelled, "the reconstruction was cancelled"};

int bits_for(GridShape shape) {
  return position_bits_for(std::max({shape.inlines, shape.crosslines, shape.samples}));
}

Result<EncodeOptions> choose_encoding(int needed, const AffineGeometry& space, const ReconstructOptions& options) {
  const int bits = options.position_bits.value_or(needed);
  if (bits < needed || bits > kMaxPositionBits) {
    return Error{ErrorCode::invalid_argument, "position bits " + std::to_string(bits) + "; this volume needs " +
                                                  std::to_string(needed) + ".." + std::to_string(kMaxPositionBits)};
  }
  EncodeOptions encode;
  encode.position_bits = bits;
  encode.speed = options.speed.value_or(encode.speed);
  encode.transform = *space.affine();
  encode.threads = options.threads;
  return encode;
}

Result<void> check_attribute_volume(const ReconstructInput& input, const ReconstructOptions& options) {
  if (!options.attributes.value) return {};
  if (input.attribute_volume == nullptr) {
    return Error{ErrorCode::invalid_argument, "the attribute \"value\" needs the volume that it is of"};
  }
  if (input.attribute_volume->shape() == input.samples.shape()) return {};
  return Error{ErrorCode::invalid_argument, "the attribute volume has another shape than the volume"};
}

Result<void> check_nodes(const ReconstructInput& input, const ReconstructOptions& options) {
  if (options.grid != GridChoice::curvilinear) return {};
  if (input.nodes == nullptr) return Error{ErrorCode::invalid_argument, "a curvilinear grid needs its nodes"};
  if (input.nodes->shape() == input.samples.shape()) return {};
  return Error{ErrorCode::invalid_argument, "the grid has another shape than the volume"};
}

BuildLodsOptions simplification(const ReconstructOptions& options, const Progress& progress) {
  BuildLodsOptions build;
  build.levels = options.levels;
  build.strategy = options.strategy;
  build.placement = options.placement;
  build.seed = options.seed;
  build.threads = options.threads;
  // M0 is prepared once, for all the levels that are measured.
  build.measure = [reference = std::make_shared<std::optional<ReferenceSurface>>(), &progress,
                   threads = options.threads](const IndexedMesh& m0, const IndexedMesh& level) {
    if (!*reference) reference->emplace(m0, DistanceOptions{.threads = threads}, progress);
    const auto distance = (*reference)->measure(level, progress);
    return distance ? distance->max_voxels : 0;  // who builds the levels learns of the cancellation as well
  };
  return build;
}

/// Everything after M0: levels are simplified one by one, and finished beside that and after it.
class Levels {
 public:
  Levels(StageSurface extracted, const StageSamples& samples, const Run& run)
      : run_(run),
        rectified_(std::move(extracted.rectified)),
        body_(std::move(extracted.surface.body)),
        levels_(run.options.levels.size()),
        m0_(begins_with_m0(run.options.levels) ? levels_.front().lod.mesh : m0_apart_),
        comparison_(m0_, run.certify(), run.progress),
        finisher_(finish_options(samples), m0_, run.options.threads - 1, run.progress) {
    for (std::size_t k = 0; k < levels_.size(); ++k) levels_[k].asked = run.options.levels[k];
    m0_ = std::move(extracted.surface.mesh);
  }

  Result<Reconstruction> make() {
    auto made = timed(run_.timings.simplify, [&] { return simplify(); });
    if (made) made = timed(run_.timings.encode, [&] { return finish(); });
    if (made) made = timed(run_.timings.certify, [&] { return compare(); });
    if (!made) return std::move(made).error();
    return Reconstruction{std::move(levels_)};
  }

 private:
  FinishOptions finish_options(const StageSamples& samples) const {
    const ReconstructOptions& options = run_.options;
    const bool is_rectified = run_.rectified() != nullptr;
    return {.sources = {.filled = samples.filled,
                        .body = options.attributes.body ? std::span(body_) : std::span<const std::uint32_t>(),
                        .normals = !options.normals ? nullptr
                                   : is_rectified   ? rectified_.samples.get()
                                                    : samples.samples,
                        .normals_first = is_rectified ? rectified_.first : GridIndex{},
                        .mirrored = run_.space.mirrored(),
                        .agreement = options.attributes.agreement ? run_.grid : nullptr,
                        .value = options.attributes.value ? run_.input.attribute_volume : nullptr,
                        .places = run_.places,
                        .flat_normals = options.normals && !run_.places.empty(),
                        .rectified = run_.rectified(),
                        .threads = options.threads},
            .keep_reliability = options.attributes.reliability,
            .encode = run_.encode,
            .certify = run_.certify()};
  }

  Result<void> simplify() {
    const BuildLodsOptions build = simplification(run_.options, run_.progress);
    if (build.placement == Placement::subset) return simplify_at_once(build);
    return build_lods_one_by_one(m0_, build, run_.progress, [&](std::size_t k, LodLevel lod) {
      ReconstructedLevel& level = levels_[k];
      const bool is_m0 = &level.lod.mesh == &m0_;
      if (!is_m0) level.lod = std::move(lod);
      finisher_.add(k, level, level.lod.mesh);
    });
  }

  /// Levels that share their vertices: M0's get other numbers too.
  Result<void> simplify_at_once(const BuildLodsOptions& build) {
    const bool m0_is_asked = begins_with_m0(build.levels);
    auto lods = build_lods(m0_is_asked ? std::move(m0_) : m0_, build, run_.progress);
    if (!lods) return std::move(lods).error();
    for (std::size_t k = 0; k < levels_.size(); ++k) {
      levels_[k].lod = std::move(lods->levels[k]);
      finisher_.add(k, levels_[k], levels_[k].lod.mesh);
    }
    return {};
  }

  /// Coarsest first. The comparison with M0, which nobody who waits for a picture should wait for, comes last.
  Result<void> finish() {
    std::size_t triangles = 0, done = 0;
    for (const ReconstructedLevel& level : levels_) triangles += level.lod.mesh.triangles.size();
    if (levels_.size() > 1 || !begins_with_m0(run_.options.levels)) comparison_.prepare(finisher_.board());
    for (std::size_t k = levels_.size(); k-- > 0;) {
      if (run_.progress.cancelled()) return kCancelled;
      run_.progress.report("encode", static_cast<double>(done) / static_cast<double>(triangles));
      if (auto finished = finisher_.finish(k); !finished) return finished;
      if (run_.on_level) run_.on_level(k, levels_[k]);
      done += levels_[k].lod.mesh.triangles.size();
    }
    run_.progress.report("encode", 1);
    return {};
  }

  Result<void> compare() {
    if (run_.progress.cancelled()) return kCancelled;
    std::vector<const IndexedMesh*> decoded;
    for (std::size_t k = 0; k < levels_.size(); ++k) decoded.push_back(&finisher_.decoded(k));
    return comparison_.compare(levels_, decoded, finisher_.board());
  }

  const Run& run_;
  const RectifiedVolume rectified_;
  const std::vector<std::uint32_t> body_;
  std::vector<ReconstructedLevel> levels_;
  IndexedMesh m0_apart_;  // when it is no level
  IndexedMesh& m0_;
  LevelComparison comparison_;
  LevelFinisher finisher_;  // last: its tasks use all of the above
};

Result<Reconstruction> run_stages(const Run& run) {
  auto samples = timed(run.timings.fill, [&] { return fill_stage(run.input, run.options, run.progress); });
  if (!samples) return std::move(samples).error();
  const GridGeometry& geometry = run.input.grid_geometry();
  const bool is_curved = is_curved_space(geometry, run.options);
  const ExtractStage stage{.bodies = run.options.attributes.body,
                           .mirrored = is_curved ? geometry.mirrored() : run.space.mirrored(),
                           .is_bent = is_curved,
                           .layers = run.layers};
  auto m0 =
      timed(run.timings.extract, [&] { return extract_stage(*samples->samples, run.options, stage, run.progress); });
  if (!m0) return std::move(m0).error();
  if (m0->empty) {
    Reconstruction nothing;
    nothing.empty = m0->empty;
    return nothing;
  }
  if (run.progress.cancelled()) return kCancelled;
  if (!is_curved) return Levels(*std::move(m0), *samples, run).make();
  const auto curved = timed(run.timings.extract, [&] {
    return bend_surface(geometry, run.input.samples.shape(), run.options, run.progress, m0->surface);
  });
  if (!curved) return curved.error();
  Run bent = run;
  bent.space = curved->space;
  bent.places = curved->places;
  auto encode = choose_encoding(position_bits_for(m0->surface.mesh), bent.space, run.options);
  if (!encode) return std::move(encode).error();
  bent.encode = *encode;
  auto result = Levels(*std::move(m0), *samples, bent).make();
  if (result) result->transform = *bent.space.affine();
  return result;
}

}  // namespace

Result<Reconstruction> reconstruct(const ReconstructInput& input, const ReconstructOptions& options, Progress& progress,
                                   StageTimings* timings, const LevelSink& on_level) {
  if (options.levels.empty()) return Error{ErrorCode::invalid_argument, "no levels asked for"};
  if (options.preview) return reconstruct_preview(input, options, progress, timings, on_level);
  if (auto checked = check_nodes(input, options); !checked) return std::move(checked).error();
  const bool is_curved = is_curved_space(input.grid_geometry(), options);
  AffineGeometry space;  // a grid that is not affine has its own, once M0 is there
  if (!is_curved) {
    auto affine = output_space(input.geometry, options);
    if (!affine) return std::move(affine).error();
    space = *affine;
  }
  if (auto checked = check_attribute_volume(input, options); !checked) return std::move(checked).error();
  StageTimings unread;
  StageTimings& spent = timings != nullptr ? *timings : unread;
  auto grid = timed(spent.grid, [&] { return grid_stage(input, options, progress); });
  if (!grid) return std::move(grid).error();
  const bool is_rectified = grid->structural != nullptr && options.index_space;
  const GridShape shape = is_rectified ? grid->structural->paths.grid() : input.samples.shape();
  auto encode = choose_encoding(bits_for(shape), space, options);
  if (!encode) return std::move(encode).error();
  const std::optional<LayerMap> layers = layer_map(*grid, input.samples.shape(), options);
  auto result = run_stages({.input = input,
                            .options = options,
                            .space = space,
                            .places = {},
                            .grid = grid->structural,
                            .layers = layers ? &*layers : nullptr,
                            .encode = *encode,
                            .progress = progress,
                            .timings = spent,
                            .on_level = on_level});
  if (!result) return result;
  result->grid = grid->report;
  if (!is_curved || result->levels.empty()) result->transform = *space.affine();
  return result;
}

}  // namespace geosis
