#include "engine/missing/gaps/gap_jobs.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>

namespace geosis {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

GridBox united(const GridBox& a, const GridBox& b) {
  GridBox all;
  for (int axis = 0; axis < 3; ++axis) {
    all.first[axis] = std::min(a.first[axis], b.first[axis]);
    all.last[axis] = std::max(a.last[axis], b.last[axis]);
  }
  return all;
}

class Planner {
 public:
  Planner(const Gaps& gaps, const GapLimits& limits) : gaps_(gaps), limits_(limits) {
    for (int axis = 0; axis < 3; ++axis) tiles_[axis] = (gaps.shape[axis] - 1) / limits.small_tile + 1;
    for (auto& jobs : tile_job_) jobs.assign(static_cast<std::size_t>(tiles_[0]) * tiles_[1] * tiles_[2], kNone);
    plan_.group_of.reserve(gaps.gaps.size());
  }

  GapPlan plan() {
    for (const Gap& gap : gaps_.gaps) add(gap);
    std::ranges::stable_sort(plan_.jobs, {}, &GapJob::wave);
    return std::move(plan_);
  }

 private:
  void add(const Gap& gap) {
    const GridShape side = shape_of(gap.box);
    const std::int32_t narrower = std::min(side.inlines, side.crosslines);
    const bool wide = narrower >= limits_.wide.first && narrower <= limits_.wide.last;
    if (std::max({side.inlines, side.crosslines, side.samples}) <= limits_.small_gap) return add_small(gap, wide);
    const GridShape margin = wide ? limits_.wide.margin : limits_.margin;
    if (shape_of(grown(gap.box, margin, gaps_.shape)).count() > limits_.whole_box) return add_tiles(gap, wide);
    plan_.group_of.push_back(groups_);
    plan_.jobs.push_back({kWholeWave, groups_++, gap.box, gap.box, {}, {}, wide});
  }
  void add_small(const Gap& gap, bool wide) {
    std::size_t tile = 0;
    for (int axis = 0; axis < 3; ++axis)
      tile = tile * static_cast<std::size_t>(tiles_[axis]) +
             static_cast<std::size_t>(gap.box.first[axis] / limits_.small_tile);
    std::uint32_t& job = tile_job_[wide ? 1 : 0][tile];
    if (job == kNone) {
      job = static_cast<std::uint32_t>(plan_.jobs.size());
      plan_.jobs.push_back({kSmallWave, groups_++, gap.box, gap.box, {}, {}, wide});
    }
    GapJob& own = plan_.jobs[job];
    own.core = own.solved = united(own.core, gap.box);
    plan_.group_of.push_back(own.group);
  }
  void add_tiles(const Gap& gap, bool wide) {
    const GridShape side = shape_of(gap.box);
    const auto even = [&](std::int32_t nodes) {
      const std::int32_t tiles = (nodes - 1) / limits_.tile + 1;
      return (nodes - 1) / tiles + 1;
    };
    GapJob job{0,   groups_, {}, {}, gap.box.first, {even(side.inlines), even(side.crosslines), even(side.samples)},
               wide};
    for (GridIndex at = gap.box.first; at.i <= gap.box.last.i; at.i += job.tile_shape.inlines) {
      for (at.j = gap.box.first.j; at.j <= gap.box.last.j; at.j += job.tile_shape.crosslines) {
        for (at.k = gap.box.first.k; at.k <= gap.box.last.k; at.k += job.tile_shape.samples) {
          job.core.first = at;
          for (int axis = 0; axis < 3; ++axis)
            job.core.last[axis] = std::min(at[axis] + job.tile_shape[axis] - 1, gap.box.last[axis]);
          job.solved = grown(job.core, {limits_.overlap, limits_.overlap, limits_.overlap}, gaps_.shape);
          job.wave = job.wave_of(at);
          plan_.jobs.push_back(job);
        }
      }
    }
    plan_.group_of.push_back(groups_++);
  }

  const Gaps& gaps_;
  const GapLimits& limits_;
  std::int32_t tiles_[3];
  /// Tile -> the job of the small gaps that begin in it; [0] narrow ones, [1] wide ones.
  std::array<std::vector<std::uint32_t>, 2> tile_job_;
  std::uint32_t groups_ = 0;
  GapPlan plan_;
};

}  // namespace

int GapJob::wave_of(GridIndex node) const {
  if (tile_shape.count() == 0) return wave;
  int colour = 0;
  for (int axis = 0; axis < 3; ++axis) colour = 2 * colour + (node[axis] - tiles_first[axis]) / tile_shape[axis] % 2;
  return kFirstTileWave + colour;
}

GapPlan plan_gap_jobs(const Gaps& gaps, const GapLimits& limits) {
  return Planner(gaps, limits).plan();
}

GridBox grown(GridBox box, GridShape layers, GridShape shape) {
  for (int axis = 0; axis < 3; ++axis) {
    box.first[axis] = std::max(box.first[axis] - layers[axis], 0);
    box.last[axis] = std::min(box.last[axis] + layers[axis], shape[axis] - 1);
  }
  return box;
}

GridShape shape_of(const GridBox& box) {
  return {box.last.i - box.first.i + 1, box.last.j - box.first.j + 1, box.last.k - box.first.k + 1};
}

}  // namespace geosis
