#include "engine/simplify/level_builder.h"

#include <cmath>
#include <cstdint>
#include <utility>

#include "engine/simplify/check_m0.h"
#include "engine/simplify/error_bound.h"

namespace geosis {
namespace {

std::int64_t triangles_for(double ratio, std::size_t triangles) {
  return static_cast<std::int64_t>(std::floor(ratio * static_cast<double>(triangles) + 0.5));
}

/// Triangles between M0 and the last level, as far as that is known before.
std::int64_t triangles_to_remove(const BuildLodsOptions& options, std::size_t triangles) {
  double least = 1;
  for (const LevelTarget& target : options.levels) least = target.ratio ? *target.ratio : 0;
  return static_cast<std::int64_t>(triangles) - triangles_for(least, triangles);
}

}  // namespace

LevelBuilder::LevelBuilder(const IndexedMesh& m0, const BuildLodsOptions& options, const WindowSizes& sizes,
                           Progress& progress)
    : m0_(m0),
      options_(options),
      watch_(progress, triangles_to_remove(options, m0.triangles.size())),
      reducer_options_{{options.strategy, options.placement, options.seed}, sizes, options.threads},
      reducer_(m0, reducer_options_, watch_) {}

Result<std::optional<LodLevel>> LevelBuilder::make(const LevelTarget& target) {
  if (target.drop.any()) {
    if (const auto dropped = drop(target.drop); !dropped) return dropped.error();
  }
  if (target.max_error) return make_within(*target.max_error);
  auto level = make_for(target);
  if (!level) return std::move(level).error();
  return std::optional(*std::move(level));
}

Result<void> LevelBuilder::begin_anew() {
  reducer_ = Reducer(m0_, reducer_options_, watch_);
  return specks_ && specks_->dropped() > 0 ? remove_dropped() : Result<void>();
}

LodLevel LevelBuilder::as_it_is() const {
  LodLevel level = reducer_.snapshot();
  level.cost = reducer_.max_cost();
  if (specks_) level.dropped_components = specks_->dropped();
  return level;
}

Result<void> LevelBuilder::drop(const DropSpecks& limits) {
  if (!specks_) specks_ = std::make_unique<Specks>(m0_);
  return specks_->drop(limits) ? remove_dropped() : Result<void>();
}

Result<void> LevelBuilder::remove_dropped() {
  return end_of(reducer_.remove([&](std::int32_t v) { return specks_->is_dropped(v); }));
}

Result<LodLevel> LevelBuilder::make_for(const LevelTarget& target) {
  Goal goal;
  if (target.ratio) goal.triangles = triangles_for(*target.ratio, m0_.triangles.size());
  if (target.max_cost) goal.max_cost = static_cast<float>(*target.max_cost);
  if (target.error_cap) {
    goal.max_error = static_cast<float>(*target.error_cap);
  } else if (target.ratio) {
    goal.max_error = static_cast<float>(default_error_cap(*target.ratio));
  }
  if (auto reduced = end_of(reducer_.reduce(goal)); !reduced) return std::move(reduced).error();
  LodLevel level = as_it_is();
  if (target.ratio) level.stopped_by = reducer_.stopped_by();
  return level;
}

Result<std::optional<LodLevel>> LevelBuilder::make_within(double max_error) {
  const auto measure = [&](const IndexedMesh& mesh) { return options_.measure(m0_, mesh); };
  PassEnd end = PassEnd::done;
  auto level = reduce_within(reducer_, max_error, measure, end);
  if (auto reduced = end_of(end); !reduced) return std::move(reduced).error();
  if (level && specks_) level->dropped_components = specks_->dropped();
  return level;
}

Result<void> LevelBuilder::end_of(PassEnd end) const {
  if (end == PassEnd::cancelled) return Error{ErrorCode::cancelled, "levels of detail: cancelled"};
  if (end == PassEnd::not_manifold) return fault_of(m0_);
  return {};
}

}  // namespace geosis
