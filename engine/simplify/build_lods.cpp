#include "engine/simplify/build_lods.h"

#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <utility>

#include "engine/mesh/check.h"
#include "engine/mesh/corner_table.h"
#include "engine/simplify/check_targets.h"
#include "engine/simplify/error_bound.h"
#include "engine/simplify/reducer.h"
#include "engine/simplify/share_vertices.h"
#include "engine/simplify/specks.h"
#include "engine/simplify/watch.h"
#include "engine/simplify/window_sizes.h"

namespace geosis {
namespace {

constexpr float kLargestCoordinate = 131'072;  // voxels; beyond, float32 does not hold all lattice points

/// Voxels. At 1/4 and 1/16, where levels should keep their count, next to nothing comes near the cap.
constexpr double kErrorCapAtRatioOne = 0.12;

const Error kCancelled = {ErrorCode::cancelled, "levels of detail: cancelled"};

Error invalid(std::string message) {
  return {ErrorCode::invalid_argument, std::move(message)};
}

bool on_lattice(float x) {
  const bool in_range = std::abs(x) <= kLargestCoordinate;  // false for NaN
  const float steps = in_range ? x * kLatticeStepsPerVoxel : 0.5f;
  return steps == static_cast<float>(static_cast<std::int32_t>(steps));
}

Result<void> check_positions(const std::vector<Vec3f>& positions) {
  for (std::size_t v = 0; v < positions.size(); ++v) {
    for (int axis = 0; axis < 3; ++axis) {
      if (on_lattice(positions[v][axis])) continue;
      return invalid("vertex " + std::to_string(v) + ": coordinate " + std::to_string(positions[v][axis]) +
                     "; expected a multiple of 1/64 within 131072 of zero");
    }
  }
  return {};
}

bool indices_in_range(const IndexedMesh& mesh) {
  const auto vertices = static_cast<std::uint32_t>(mesh.positions.size());
  bool in_range = mesh.positions.size() <= std::numeric_limits<std::int32_t>::max();
  for (const auto& [a, b, c] : mesh.triangles) {
    in_range &= (static_cast<std::uint32_t>(a) < vertices) & (static_cast<std::uint32_t>(b) < vertices) &
                (static_cast<std::uint32_t>(c) < vertices);
  }
  return in_range;
}

/// Says what is wrong with a mesh that is no manifold.
Error fault_of(const IndexedMesh& m0) {
  const auto table = build_corner_table(m0);
  if (!table) return table.error();
  if (auto fans = check_fans(*table, m0.positions.size()); !fans) return std::move(fans).error();
  return {ErrorCode::internal, "levels of detail: a manifold was taken for something else"};
}

std::int64_t triangles_for(double ratio, std::size_t triangles) {
  return static_cast<std::int64_t>(ratio * static_cast<double>(triangles) + 0.5);
}

/// Triangles between M0 and the last level, as far as that is known before.
std::int64_t triangles_to_remove(const BuildLodsOptions& options, std::size_t triangles) {
  double least = 1;
  for (const LevelTarget& target : options.levels) least = target.ratio ? *target.ratio : 0;
  return static_cast<std::int64_t>(triangles) - triangles_for(least, triangles);
}

/// Makes one level after the other.
class Builder {
 public:
  Builder(const IndexedMesh& m0, const BuildLodsOptions& options, const WindowSizes& sizes, Progress& progress)
      : m0_(m0),
        options_(options),
        watch_(progress, triangles_to_remove(options, m0.triangles.size())),
        reducer_options_{{options.strategy, options.placement, options.seed}, sizes, options.threads},
        reducer_(m0, reducer_options_, watch_) {}

  /// The level's mesh is left empty where it is M0.
  Result<LodLevel> make(const LevelTarget& target) {
    if (target.drop.any()) {
      if (const auto dropped = drop(target.drop); !dropped) return dropped.error();
    }
    Result<LodLevel> level = target.max_error ? make_within(*target.max_error) : make_for(target);
    if (!level) return level;
    if (target.ratio) level->asked_ratio = *target.ratio;
    if (specks_) level->dropped_components = specks_->dropped();
    return level;
  }

 private:
  Result<void> drop(const DropSpecks& limits) {
    if (!specks_) specks_ = std::make_unique<Specks>(m0_);
    if (!specks_->drop(limits)) return {};
    return end_of(reducer_.remove([&](std::int32_t v) { return specks_->is_dropped(v); }));
  }

  Result<LodLevel> make_for(const LevelTarget& target) {
    if (target.ratio == 1.0 && !specks_) return LodLevel{};
    Goal goal;
    if (target.ratio) goal.triangles = triangles_for(*target.ratio, m0_.triangles.size());
    if (target.max_cost) goal.max_cost = static_cast<float>(*target.max_cost);
    if (target.error_cap) {
      goal.max_error = static_cast<float>(*target.error_cap);
    } else if (target.ratio) {
      goal.max_error = static_cast<float>(default_error_cap(*target.ratio));
    }
    if (auto reduced = end_of(reducer_.reduce(goal)); !reduced) return std::move(reduced).error();
    LodLevel level = reducer_.snapshot();
    level.cost = reducer_.max_cost();
    if (target.ratio) level.stopped_by = reducer_.stopped_by();
    return level;
  }

  Result<LodLevel> make_within(double max_error) {
    const auto measure = [&](const IndexedMesh& mesh) { return options_.measure(m0_, mesh); };
    PassEnd end = PassEnd::done;
    auto level = reduce_within(reducer_, max_error, measure, end);
    if (!level && end == PassEnd::done) {
      if (options_.placement == Placement::subset) {
        return invalid("levels of detail: max_error " + std::to_string(max_error) + " after a coarser level");
      }
      // The level before is too far off already: begin anew.
      reducer_ = Reducer(m0_, reducer_options_, watch_);
      if (specks_ && specks_->dropped() > 0)
        end = reducer_.remove([&](std::int32_t v) { return specks_->is_dropped(v); });
      if (end == PassEnd::done) level = reduce_within(reducer_, max_error, measure, end);
    }
    if (auto reduced = end_of(end); !reduced) return std::move(reduced).error();
    // What was dropped may lie farther off than any simplification: then nothing coarser than the rest will do.
    return level ? *std::move(level) : reducer_.snapshot();
  }

  Result<void> end_of(PassEnd end) const {
    if (end == PassEnd::cancelled) return kCancelled;
    if (end == PassEnd::not_manifold) return fault_of(m0_);
    return {};
  }

  const IndexedMesh& m0_;
  const BuildLodsOptions& options_;
  Watch watch_;
  const ReducerOptions reducer_options_;
  Reducer reducer_;
  std::unique_ptr<Specks> specks_;
};

Result<void> check_input(const IndexedMesh& m0, const BuildLodsOptions& options) {
  if (auto sound = check_targets(options); !sound) return sound;
  if (auto lattice = check_positions(m0.positions); !lattice) return lattice;
  if (!indices_in_range(m0)) return fault_of(m0);
  return {};
}

}  // namespace

std::vector<LevelTarget> by_ratio(const std::vector<double>& ratios) {
  std::vector<LevelTarget> levels;
  for (const double ratio : ratios) levels.push_back({.ratio = ratio});
  return levels;
}

double default_error_cap(double ratio) {
  return kErrorCapAtRatioOne / std::sqrt(ratio);
}

Result<LodHierarchy> build_lods_in_windows(IndexedMesh m0, const BuildLodsOptions& options, const WindowSizes& sizes,
                                           Progress& progress) {
  if (auto sound = check_input(m0, options); !sound) return std::move(sound).error();
  progress.report("simplify", 0);
  if (progress.cancelled()) return kCancelled;
  LodHierarchy hierarchy;
  bool first_is_m0 = false;
  {
    Builder builder(m0, options, sizes, progress);
    for (const LevelTarget& target : options.levels) {
      auto level = builder.make(target);
      if (!level) return std::move(level).error();
      first_is_m0 = first_is_m0 || (target.ratio == 1.0 && level->dropped_components == 0);
      hierarchy.levels.push_back(*std::move(level));
    }
  }
  const std::size_t m0_vertices = m0.positions.size();
  if (first_is_m0) hierarchy.levels.front().mesh = std::move(m0);
  if (options.placement == Placement::subset) share_vertices(hierarchy, m0_vertices);
  return hierarchy;
}

Result<LodHierarchy> build_lods(IndexedMesh m0, const BuildLodsOptions& options, Progress& progress) {
  return build_lods_in_windows(std::move(m0), options, {}, progress);
}

}  // namespace geosis
