#include "engine/pipeline/finish_levels.h"

#include <algorithm>
#include <atomic>
#include <optional>
#include <string>
#include <utility>

#include "engine/codec/check_level.h"
#include "engine/codec/cut_parts.h"
#include "engine/codec/draco_part.h"
#include "engine/codec/join_parts.h"

namespace geosis {
namespace {

/// Levels that spare threads have between their attributes and their description, so that what is decoded and not yet
/// described stays bounded.
constexpr int kMostInFlight = 2;

Error cancelled() {
  return {ErrorCode::cancelled, "the encoding of a level was cancelled"};
}

Error of_part(std::size_t part, const Error& error) {
  if (error.code == ErrorCode::cancelled) return error;
  return {error.code, "part " + std::to_string(part) + ": " + error.message};
}

}  // namespace

struct LevelFinisher::Work {
  Work(std::size_t its_number, ReconstructedLevel& its_level, const IndexedMesh& its_mesh)
      : number(its_number), level(its_level), mesh(its_mesh) {}

  const std::size_t number;
  ReconstructedLevel& level;
  const IndexedMesh& mesh;
  bool begun = false;
  PartPlan plan = {};
  std::vector<MeshPart> parts = {};                 // as decoded
  std::vector<std::optional<Error>> problems = {};  // of the parts
  std::atomic<std::size_t> parts_left = 0;
  IndexedMesh decoded = {};
  Result<void> result = {};
  std::atomic<bool> ended = false;

  int urgency() const { return static_cast<int>(number); }
};

LevelFinisher::LevelFinisher(const FinishOptions& options, const IndexedMesh& m0, int helpers, const Progress& progress)
    : options_(options), m0_(m0), progress_(progress), has_helpers_(helpers > 0), board_(helpers) {}

LevelFinisher::~LevelFinisher() = default;

void LevelFinisher::add(std::size_t number, ReconstructedLevel& level, const IndexedMesh& mesh) {
  {
    const std::lock_guard lock(mutex_);
    works_.push_back(std::make_unique<Work>(number, level, mesh));
  }
  begin_next();
}

Result<void> LevelFinisher::finish(std::size_t number) {
  Work& work = *find(number);
  begin(work);
  // Nobody who waits for this level waits for a finer one; beside the finest, comparisons are all that is left.
  board_.work_until(number == 0 ? kComparisonUrgency : work.urgency(), [&] { return work.ended.load(); });
  return work.result;
}

const IndexedMesh& LevelFinisher::decoded(std::size_t number) const {
  return find(number)->decoded;
}

LevelFinisher::Work* LevelFinisher::find(std::size_t number) const {
  const std::lock_guard lock(mutex_);
  return std::ranges::find(works_, number, [](const auto& work) { return work->number; })->get();
}

void LevelFinisher::begin(Work& work) {
  {
    const std::lock_guard lock(mutex_);
    if (std::exchange(work.begun, true)) return;
    ++in_flight_;
  }
  board_.add(work.urgency(), [this, &work] { prepare(work); });
}

/// Gives spare threads another level, if there is one and few are in flight: the coarsest.
void LevelFinisher::begin_next() {
  Work* next = nullptr;
  {
    const std::lock_guard lock(mutex_);
    if (!has_helpers_ || in_flight_ >= kMostInFlight) return;
    for (const auto& work : works_) {
      if (!work->begun && (next == nullptr || work->number > next->number)) next = work.get();
    }
  }
  if (next != nullptr) begin(*next);
}

void LevelFinisher::prepare(Work& work) {
  auto attributes = attributes_of(work.mesh, work.level.lod.origin, options_.sources, progress_);
  if (!attributes) return end(work, std::move(attributes).error());
  work.level.attributes = *std::move(attributes);
  work.level.interpolated_share = interpolated_share(work.level.attributes.reliability);
  if (!options_.keep_reliability) work.level.attributes.reliability.clear();
  if (auto sound = check_level(work.mesh, work.level.attributes, options_.encode); !sound) return end(work, sound);
  if (progress_.cancelled()) return end(work, cancelled());
  work.plan = plan_parts(work.mesh, options_.encode.max_part_triangles);
  const std::size_t parts = work.plan.parts();
  work.level.encoded.parts.resize(parts);
  work.parts.resize(parts);
  work.problems.resize(parts);
  work.parts_left = parts;
  for (std::size_t part = 0; part < parts; ++part) {
    board_.add(work.urgency(), [this, &work, part] { code_part(work, part); });
  }
}

void LevelFinisher::code_part(Work& work, std::size_t part) {
  work.problems[part] = [&]() -> std::optional<Error> {
    if (progress_.cancelled()) return cancelled();
    auto encoded = encode_part(cut_part(work.mesh, work.level.attributes, work.plan, part), options_.encode);
    if (!encoded) return of_part(part, encoded.error());
    if (progress_.cancelled()) return cancelled();
    auto decoded = decode_part(encoded->bytes);
    if (!decoded) return of_part(part, decoded.error());
    work.level.encoded.parts[part] = *std::move(encoded);
    work.parts[part] = *std::move(decoded);
    return std::nullopt;
  }();
  if (--work.parts_left > 0) return;
  board_.add(work.urgency(), [this, &work] { join_and_describe(work); });
}

void LevelFinisher::join_and_describe(Work& work) {
  for (const auto& problem : work.problems) {
    if (problem) return end(work, *problem);
  }
  auto joined = join_parts(std::move(work.parts), progress_);
  if (!joined) return end(work, std::move(joined).error());
  work.plan = {};
  if (auto described = describe_level(joined->mesh, options_.certify, progress_, work.level); !described) {
    return end(work, std::move(described));
  }
  if (&work.mesh != &m0_) work.decoded = std::move(joined->mesh);
  end(work, {});
}

void LevelFinisher::end(Work& work, Result<void> result) {
  work.result = std::move(result);
  {
    const std::lock_guard lock(mutex_);
    --in_flight_;
  }
  begin_next();
  work.ended = true;
}

}  // namespace geosis
