#include "engine/pipeline/reconstruct.h"

#include <algorithm>
#include <chrono>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "engine/pipeline/certify.h"
#include "engine/pipeline/level_attributes.h"
#include "engine/pipeline/output_space.h"
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
  const AffineGeometry& space;  ///< from index coordinates to the requested space
  EncodeOptions encode;
  Progress& progress;
  StageTimings& timings;
  const LevelSink& on_level;

  CertifyOptions certify() const { return {space, input.has_lengths, options.threads}; }
};

const Error kCancelled = {ErrorCode::cancelled, "the reconstruction was cancelled"};

Result<EncodeOptions> choose_encoding(GridShape shape, const AffineGeometry& space, const ReconstructOptions& options) {
  const int needed = position_bits_for(std::max({shape.inlines, shape.crosslines, shape.samples}));
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

/// Whether level 0 is M0 itself, the reference of every certificate.
bool is_m0(const LevelTarget& level) {
  return level.ratio == 1.0 && !level.drop.any();
}

Result<LodHierarchy> simplify(IndexedMesh m0, const Run& run) {
  const StageTimer timer(run.timings.simplify);
  BuildLodsOptions build;
  build.levels = run.options.levels;
  build.strategy = run.options.strategy;
  build.placement = run.options.placement;
  build.seed = run.options.seed;
  build.threads = run.options.threads;
  std::optional<ReferenceSurface> reference;  // M0 is prepared once, for all the levels that are measured
  build.measure = [&](const IndexedMesh& original, const IndexedMesh& level) {
    if (!reference) reference.emplace(original, DistanceOptions{.threads = run.options.threads});
    return reference->measure(level).max_voxels;
  };
  return build_lods(std::move(m0), build, run.progress);
}

/// The level's values, its share of interpolated vertices, and its bytes.
Result<void> encode(const AttributeSources& sources, const Run& run, ReconstructedLevel& level) {
  const StageTimer timer(run.timings.encode);
  auto attributes = attributes_of(level.lod, sources, run.progress);
  if (!attributes) return std::move(attributes).error();
  level.attributes = *std::move(attributes);
  level.interpolated_share = interpolated_share(level.attributes.reliability);
  if (!run.options.attributes.reliability) level.attributes.reliability.clear();
  auto encoded = encode_level(level.lod.mesh, level.attributes, run.encode, run.progress);
  if (!encoded) return std::move(encoded).error();
  level.encoded = *std::move(encoded);
  return {};
}

/// What a client will see of the level.
Result<IndexedMesh> decode(const EncodedLevel& encoded, const Run& run) {
  const StageTimer timer(run.timings.certify);
  std::vector<std::span<const std::byte>> parts;
  for (const EncodedPart& part : encoded.parts) parts.emplace_back(part.bytes);
  auto decoded = decode_level(parts, run.options.threads, run.progress);
  if (!decoded) return std::move(decoded).error();
  return std::move(decoded->mesh);
}

void describe(const IndexedMesh& decoded, const Run& run, ReconstructedLevel& level) {
  const StageTimer timer(run.timings.certify);
  describe_level(decoded, run.certify(), level);
}

/// Encodes the levels from the coarsest on and describes what they decode to; the decoded meshes are returned for the
/// comparison with M0, which nobody who waits for a picture should wait for.
Result<std::vector<IndexedMesh>> encode_levels(std::vector<ReconstructedLevel>& levels, const AttributeSources& sources,
                                               const Run& run) {
  std::vector<IndexedMesh> decoded(levels.size());
  std::size_t triangles = 0, done = 0;
  for (const ReconstructedLevel& level : levels) triangles += level.lod.mesh.triangles.size();
  for (std::size_t k = levels.size(); k-- > 0;) {
    if (run.progress.cancelled()) return kCancelled;
    run.progress.report("encode", static_cast<double>(done) / static_cast<double>(triangles));
    if (auto encoded = encode(sources, run, levels[k]); !encoded) return std::move(encoded).error();
    auto mesh = decode(levels[k].encoded, run);
    if (!mesh) return std::move(mesh).error();
    decoded[k] = *std::move(mesh);
    describe(decoded[k], run, levels[k]);
    if (run.on_level) run.on_level(k, levels[k]);
    done += levels[k].lod.mesh.triangles.size();
  }
  run.progress.report("encode", 1);
  return decoded;
}

std::vector<ReconstructedLevel> take_levels(std::vector<LodLevel>&& lods, const std::vector<LevelTarget>& asked) {
  std::vector<ReconstructedLevel> levels(lods.size());
  for (std::size_t k = 0; k < levels.size(); ++k) {
    levels[k].asked = asked[k];
    levels[k].lod = std::move(lods[k]);
  }
  return levels;
}

/// Everything after M0.
Result<Reconstruction> make_levels(LabelledSurface m0, const StageSamples& samples, const Run& run) {
  const std::vector<std::uint32_t> body = std::move(m0.body);
  const AttributeSources sources{
      .filled = samples.filled,
      .body = run.options.attributes.body ? std::span(body) : std::span<const std::uint32_t>(),
      .normals = run.options.normals ? samples.samples : nullptr,
      .mirrored = run.space.mirrored(),
      .value = run.options.attributes.value ? run.input.attribute_volume : nullptr,
      .threads = run.options.threads};
  const bool m0_is_asked = is_m0(run.options.levels.front());
  const IndexedMesh m0_apart = m0_is_asked ? IndexedMesh{} : m0.mesh;
  auto lods = simplify(std::move(m0.mesh), run);
  if (!lods) return std::move(lods).error();
  Reconstruction result{take_levels(std::move(lods->levels), run.options.levels)};
  auto decoded = encode_levels(result.levels, sources, run);
  if (!decoded) return std::move(decoded).error();
  const IndexedMesh& reference = m0_is_asked ? result.levels.front().lod.mesh : m0_apart;
  const StageTimer timer(run.timings.certify);
  auto compared = compare_with_m0(result.levels, *decoded, reference, run.certify(), run.progress);
  if (!compared) return std::move(compared).error();
  return result;
}

Result<Reconstruction> run_stages(const Run& run) {
  auto samples = timed(run.timings.fill, [&] { return fill_stage(run.input, run.options, run.progress); });
  if (!samples) return std::move(samples).error();
  const ExtractStage stage{.bodies = run.options.attributes.body, .mirrored = run.space.mirrored()};
  auto m0 =
      timed(run.timings.extract, [&] { return extract_stage(*samples->samples, run.options, stage, run.progress); });
  if (!m0) return std::move(m0).error();
  if (m0->mesh.triangles.empty()) return Reconstruction{};
  if (run.progress.cancelled()) return kCancelled;
  return make_levels(*std::move(m0), *samples, run);
}

}  // namespace

Result<Reconstruction> reconstruct(const ReconstructInput& input, const ReconstructOptions& options, Progress& progress,
                                   StageTimings* timings, const LevelSink& on_level) {
  if (options.levels.empty()) return Error{ErrorCode::invalid_argument, "no levels asked for"};
  const auto space = output_space(input.geometry, options);
  if (!space) return space.error();
  auto encode = choose_encoding(input.samples.shape(), *space, options);
  if (!encode) return std::move(encode).error();
  if (auto checked = check_attribute_volume(input, options); !checked) return std::move(checked).error();
  StageTimings unread;
  return run_stages({.input = input,
                     .options = options,
                     .space = *space,
                     .encode = *encode,
                     .progress = progress,
                     .timings = timings != nullptr ? *timings : unread,
                     .on_level = on_level});
}

}  // namespace geosis
