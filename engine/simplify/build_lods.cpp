#include "engine/simplify/build_lods.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>

#include "engine/simplify/check_m0.h"
#include "engine/simplify/check_targets.h"
#include "engine/simplify/level_builder.h"
#include "engine/simplify/share_vertices.h"
#include "engine/simplify/window_sizes.h"

namespace geosis {
namespace {

/// Voxels. At 1/4 and 1/16, where levels should keep their count, next to nothing comes near the cap.
constexpr double kErrorCapAtRatioOne = 0.12;

Result<void> check_input(const IndexedMesh& m0, const BuildLodsOptions& options, Progress& progress) {
  if (auto sound = check_targets(options); !sound) return sound;
  if (auto sound = check_m0(m0, options.threads); !sound) return sound;
  progress.report("simplify", 0);
  if (progress.cancelled()) return Error{ErrorCode::cancelled, "levels of detail: cancelled"};
  return {};
}

/// Level after level. One whose error the level before exceeds already begins anew from M0.
Result<void> build_in_order(const IndexedMesh& m0, const BuildLodsOptions& options, const WindowSizes& sizes,
                            Progress& progress, const TakeLevel& take) {
  LevelBuilder builder(m0, options, sizes, progress);
  for (std::size_t k = 0; k < options.levels.size(); ++k) {
    if (k == 0 && begins_with_m0(options.levels)) {
      take(0, {});
      continue;
    }
    auto level = builder.make(options.levels[k]);
    if (level && !*level) {
      if (auto begun = builder.begin_anew(); !begun) return begun;
      level = builder.make(options.levels[k]);
    }
    if (!level) return std::move(level).error();
    // What was dropped may lie farther off than any simplification: then nothing coarser than the rest will do.
    take(k, *level ? **std::move(level) : builder.as_it_is());
  }
  return {};
}

/// What is dropped from each level: what it asks for and what those before it do.
std::vector<DropSpecks> drops_by_level(const std::vector<LevelTarget>& levels) {
  std::vector<DropSpecks> drops;
  DropSpecks all;
  for (const LevelTarget& level : levels) {
    all.max_voxels = std::max(all.max_voxels, level.drop.max_voxels);
    all.max_error = std::max(all.max_error, level.drop.max_error);
    drops.push_back(all);
  }
  return drops;
}

/// Levels of which each has a subset of the vertices of all finer ones, so that none can begin anew: each is made from
/// the next finer one, whatever order they are asked for in.
class NestedLevels {
 public:
  NestedLevels(const IndexedMesh& m0, const BuildLodsOptions& options, const WindowSizes& sizes, Progress& progress)
      : m0_(m0), options_(options), sizes_(sizes), progress_(progress), drops_(drops_by_level(options.levels)) {
    order_.resize(options.levels.size());
    std::iota(order_.begin(), order_.end(), std::size_t{0});
  }

  Result<std::vector<LodLevel>> build() {
    for (;;) {
      std::vector<LodLevel> levels(order_.size());
      const auto too_coarse = build_in_order(levels);
      if (!too_coarse) return too_coarse.error();
      if (*too_coarse == order_.size()) return levels;
      if (auto moved = move_forward(*too_coarse); !moved) return std::move(moved).error();
    }
  }

 private:
  /// returns   the place of the first level whose error the one before it exceeds already; none = their number.
  Result<std::size_t> build_in_order(std::vector<LodLevel>& levels) const {
    LevelBuilder builder(m0_, options_, sizes_, progress_);
    for (std::size_t place = begins_with_m0(options_.levels) ? 1 : 0; place < order_.size(); ++place) {
      const std::size_t k = order_[place];
      LevelTarget target = options_.levels[k];
      target.drop = drops_[k];
      auto level = builder.make(target);
      if (!level) return std::move(level).error();
      if (!*level && may_move(place)) return place;
      levels[k] = *level ? **std::move(level) : builder.as_it_is();
    }
    return order_.size();
  }

  /// A level that another one by error stands before fails by what was dropped: it is as far off wherever it stands.
  bool may_move(std::size_t place) const {
    if (place == 0) return false;
    const std::size_t before = order_[place - 1];
    return !(before == 0 && begins_with_m0(options_.levels)) && !options_.levels[before].max_error;
  }

  Result<void> move_forward(std::size_t place) {
    const std::size_t k = order_[place], before = order_[place - 1];
    if (drops_[k].max_voxels > drops_[before].max_voxels || drops_[k].max_error > drops_[before].max_error) {
      return Error{ErrorCode::unsupported,
                   "levels of detail: level " + std::to_string(before) + " is farther from M0 than the max_error of " +
                       std::to_string(*options_.levels[k].max_error) + " of level " + std::to_string(k) +
                       ", which drops components that it keeps; with subset one must have all vertices of the other"};
    }
    std::swap(order_[place - 1], order_[place]);
    return {};
  }

  const IndexedMesh& m0_;
  const BuildLodsOptions& options_;
  const WindowSizes& sizes_;
  Progress& progress_;
  std::vector<DropSpecks> drops_;
  std::vector<std::size_t> order_;  // in which levels are made, finest first
};

Result<std::vector<LodLevel>> build_all(const IndexedMesh& m0, const BuildLodsOptions& options,
                                        const WindowSizes& sizes, Progress& progress) {
  if (options.placement == Placement::subset) return NestedLevels(m0, options, sizes, progress).build();
  std::vector<LodLevel> levels(options.levels.size());
  auto built = build_in_order(m0, options, sizes, progress,
                              [&](std::size_t k, LodLevel level) { levels[k] = std::move(level); });
  if (!built) return std::move(built).error();
  return levels;
}

}  // namespace

std::vector<LevelTarget> by_ratio(const std::vector<double>& ratios) {
  std::vector<LevelTarget> levels(ratios.size());
  for (std::size_t k = 0; k < ratios.size(); ++k) levels[k].ratio = ratios[k];
  return levels;
}

bool begins_with_m0(const std::vector<LevelTarget>& levels) {
  return !levels.empty() && levels.front().ratio == 1.0 && !levels.front().drop.any();
}

double default_error_cap(double ratio) {
  return kErrorCapAtRatioOne / std::sqrt(ratio);
}

Result<LodHierarchy> build_lods_in_windows(IndexedMesh m0, const BuildLodsOptions& options, const WindowSizes& sizes,
                                           Progress& progress) {
  if (auto sound = check_input(m0, options, progress); !sound) return std::move(sound).error();
  auto levels = build_all(m0, options, sizes, progress);
  if (!levels) return std::move(levels).error();
  LodHierarchy hierarchy{*std::move(levels)};
  const std::size_t m0_vertices = m0.positions.size();
  if (begins_with_m0(options.levels)) hierarchy.levels.front().mesh = std::move(m0);
  if (options.placement == Placement::subset) share_vertices(hierarchy, m0_vertices);
  return hierarchy;
}

Result<LodHierarchy> build_lods(IndexedMesh m0, const BuildLodsOptions& options, Progress& progress) {
  return build_lods_in_windows(std::move(m0), options, {}, progress);
}

Result<void> build_lods_one_by_one(const IndexedMesh& m0, const BuildLodsOptions& options, Progress& progress,
                                   const TakeLevel& take) {
  if (options.placement == Placement::subset) {
    return Error{ErrorCode::unsupported, "levels of detail: levels that share their vertices come all at once"};
  }
  if (auto sound = check_input(m0, options, progress); !sound) return sound;
  return build_in_order(m0, options, {}, progress, take);
}

}  // namespace geosis
