#include "engine/pipeline/reconstruct.h"

#include <algorithm>
#include <chrono>
#include <optional>
#include <span>
#include <string>
#include <utility>

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

/// What all stages of one reconstruction share.
struct Run {
  const ReconstructOptions& options;
  const GridGeometry& space;  ///< from index coordinates to the requested space
  EncodeOptions encode;
  Progress& progress;
  StageTimings& timings;
  const LevelSink& on_level;
};

const Error kCancelled = {ErrorCode::cancelled, "the reconstruction was cancelled"};

bool same_mesh(const IndexedMesh& a, const IndexedMesh& b) {
  return a.positions == b.positions && a.triangles == b.triangles;
}

Result<EncodeOptions> choose_encoding(GridShape shape, const GridGeometry& space, const ReconstructOptions& options) {
  const int needed = position_bits_for(std::max({shape.inlines, shape.crosslines, shape.samples}));
  const int bits = options.position_bits.value_or(needed);
  if (bits < needed || bits > kMaxPositionBits) {
    return Error{ErrorCode::invalid_argument, "position bits " + std::to_string(bits) + "; this volume needs " +
                                                  std::to_string(needed) + ".." + std::to_string(kMaxPositionBits)};
  }
  if (space.affine() == nullptr) {
    return Error{ErrorCode::unsupported, "world space of a grid that is not affine; ask for index space"};
  }
  EncodeOptions encode;
  encode.position_bits = bits;
  encode.speed = options.speed.value_or(encode.speed);
  encode.transform = *space.affine();
  encode.threads = options.threads;
  return encode;
}

Result<IndexedMesh> extract(const BrickedVolume& volume, const Run& run) {
  const StageTimer timer(run.timings.extract);
  ExtractOptions extract;
  extract.mode = run.options.mode;
  extract.cap = run.options.cap;
  extract.region = run.options.region.value_or(whole(volume.shape()));
  extract.mirrored = run.space.mirrored();
  extract.threads = run.options.threads;
  return extract_body(volume, run.options.range, extract, run.progress);
}

/// Level 0 is always M0, the reference of every certificate, whether or not the request asks for ratio 1.
Result<LodHierarchy> simplify(IndexedMesh m0, const Run& run) {
  const StageTimer timer(run.timings.simplify);
  BuildLodsOptions build;
  build.levels = by_ratio(run.options.ratios);
  if (build.levels.empty() || build.levels.front().ratio != 1) build.levels.insert(build.levels.begin(), {.ratio = 1});
  build.threads = run.options.threads;
  return build_lods(std::move(m0), build, run.progress);
}

Result<EncodedLevel> encode(const IndexedMesh& mesh, const Run& run) {
  const StageTimer timer(run.timings.encode);
  return encode_level(mesh, run.encode, run.progress);
}

/// What a client will see of the level.
Result<IndexedMesh> decode(const EncodedLevel& encoded, const Run& run) {
  const StageTimer timer(run.timings.certify);
  std::vector<std::span<const std::byte>> parts;
  for (const EncodedPart& part : encoded.parts) parts.emplace_back(part.bytes);
  return decode_level(parts, run.options.threads, run.progress);
}

void describe(const IndexedMesh& decoded, const Run& run, ReconstructedLevel& level) {
  const StageTimer timer(run.timings.certify);
  level.topology = report_topology(decoded);
  level.measures = measure_surface(decoded, run.space);
}

/// Encodes the levels from the coarsest on and describes what they decode to; the decoded meshes are returned for the
/// comparison with M0, which nobody who waits for a picture should wait for.
Result<std::vector<IndexedMesh>> encode_levels(std::vector<ReconstructedLevel>& levels, const Run& run) {
  std::vector<IndexedMesh> decoded(levels.size());
  std::size_t triangles = 0, done = 0;
  for (const ReconstructedLevel& level : levels) triangles += level.lod.mesh.triangles.size();
  for (std::size_t k = levels.size(); k-- > 0;) {
    if (run.progress.cancelled()) return kCancelled;
    run.progress.report("encode", static_cast<double>(done) / static_cast<double>(triangles));
    auto encoded = encode(levels[k].lod.mesh, run);
    if (!encoded) return std::move(encoded).error();
    levels[k].encoded = *std::move(encoded);
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

/// Distance and volume drift of every level: none for M0 itself, the same for levels that stopped at the same floor.
Result<void> compare_with_m0(std::vector<ReconstructedLevel>& levels, const std::vector<IndexedMesh>& decoded,
                             const IndexedMesh& m0, const Run& run) {
  const StageTimer timer(run.timings.certify);
  const double m0_volume = measure_surface(m0, run.space).volume;
  std::optional<ReferenceSurface> reference;
  for (std::size_t k = levels.size(); k-- > 0;) {
    if (run.progress.cancelled()) return kCancelled;
    run.progress.report("certify", 1 - static_cast<double>(k + 1) / static_cast<double>(levels.size()));
    ReconstructedLevel& level = levels[k];
    if (same_mesh(level.lod.mesh, m0)) continue;
    if (m0_volume != 0) level.volume_drift = (level.measures.volume - m0_volume) / m0_volume;
    if (k + 1 < levels.size() && same_mesh(level.lod.mesh, levels[k + 1].lod.mesh)) {
      level.distance = levels[k + 1].distance;
      continue;
    }
    if (!reference) reference.emplace(m0, DistanceOptions{.threads = run.options.threads});
    level.distance = reference->measure(decoded[k]);
  }
  run.progress.report("certify", 1);
  return {};
}

/// The hierarchy's levels that were asked for: all of them, or all but M0.
std::vector<ReconstructedLevel> take_levels(std::vector<LodLevel>&& lods, std::size_t first) {
  std::vector<ReconstructedLevel> levels(lods.size() - first);
  for (std::size_t k = 0; k < levels.size(); ++k) levels[k].lod = std::move(lods[first + k]);
  return levels;
}

Result<Reconstruction> run_stages(const BrickedVolume& volume, const Run& run) {
  auto m0 = extract(volume, run);
  if (!m0) return std::move(m0).error();
  if (m0->triangles.empty()) return Reconstruction{};
  if (run.progress.cancelled()) return kCancelled;

  auto lods = simplify(*std::move(m0), run);
  if (!lods) return std::move(lods).error();
  const std::size_t asked = run.options.ratios.size();
  const bool m0_is_asked = lods->levels.size() == asked;
  std::optional<IndexedMesh> m0_apart;
  if (!m0_is_asked) m0_apart = std::move(lods->levels.front().mesh);

  Reconstruction result{take_levels(std::move(lods->levels), m0_is_asked ? 0 : 1)};
  auto decoded = encode_levels(result.levels, run);
  if (!decoded) return std::move(decoded).error();
  const IndexedMesh& reference = m0_apart ? *m0_apart : result.levels.front().lod.mesh;
  if (auto compared = compare_with_m0(result.levels, *decoded, reference, run); !compared) return compared.error();
  return result;
}

}  // namespace

Result<Reconstruction> reconstruct(const BrickedVolume& volume, const GridGeometry& geometry,
                                   const ReconstructOptions& options, Progress& progress, StageTimings* timings,
                                   const LevelSink& on_level) {
  const AffineGeometry index_space;
  const GridGeometry& space = options.index_space ? index_space : geometry;
  auto encode = choose_encoding(volume.shape(), space, options);
  if (!encode) return std::move(encode).error();
  StageTimings unread;
  return run_stages(volume, {.options = options,
                             .space = space,
                             .encode = *encode,
                             .progress = progress,
                             .timings = timings != nullptr ? *timings : unread,
                             .on_level = on_level});
}

}  // namespace geosis
