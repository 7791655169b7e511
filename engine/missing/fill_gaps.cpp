#include "engine/missing/fill_gaps.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "engine/base/parallel.h"
#include "engine/missing/gaps/gap_reader.h"
#include "engine/missing/gaps/gaps.h"
#include "engine/volume/brick_layout.h"

namespace geosis {
namespace {

// Boxes take up to 60 bytes a node while they are solved; so many at once stay below half a gigabyte.
constexpr int kSmallAtOnce = 6, kBigAtOnce = 2;

/// The nodes that two boxes share; empty if first is beyond last on an axis.
GridBox common(const GridBox& a, const GridBox& b) {
  GridBox both;
  for (int axis = 0; axis < 3; ++axis) {
    both.first[axis] = std::max(a.first[axis], b.first[axis]);
    both.last[axis] = std::min(a.last[axis], b.last[axis]);
  }
  return both;
}

/// Takes the values of a solved gap into the records of every brick that holds its nodes.
class Keeper {
 public:
  Keeper(const BrickedVolume& volume, FillWriter& writer)
      : layout_(volume.shape()), range_(value_range(volume)), writer_(writer) {}

  void keep(const GapBox& gap, const GridBox& core) {
    std::int32_t first[3], last[3];
    for (int axis = 0; axis < 3; ++axis) {
      // A node on a shared layer is in the brick before, too.
      first[axis] = std::max(core.first[axis] - 1, 0) / kBrickCells;
      last[axis] = std::min(core.last[axis] / kBrickCells, layout_.grid()[axis] - 1);
      first[axis] = std::min(first[axis], last[axis]);
    }
    for (std::int32_t bi = first[0]; bi <= last[0]; ++bi)
      for (std::int32_t bj = first[1]; bj <= last[1]; ++bj)
        for (std::int32_t bk = first[2]; bk <= last[2]; ++bk) keep_in({bi, bj, bk}, gap, core);
  }

 private:
  void keep_in(GridIndex brick, const GapBox& gap, const GridBox& core) {
    const std::span<FilledSample> records = writer_.records(layout_.number(brick));
    const GridIndex corner = layout_.first_node(brick);
    const GridShape extent = layout_.extent(brick);
    const GridBox part = common(
        core,
        {corner, {corner.i + extent.inlines - 1, corner.j + extent.crosslines - 1, corner.k + extent.samples - 1}});
    for (std::int32_t i = part.first.i; i <= part.last.i; ++i) {
      for (std::int32_t j = part.first.j; j <= part.last.j; ++j) {
        const std::int32_t row = ((i - corner.i) * extent.crosslines + (j - corner.j)) * extent.samples - corner.k;
        const auto end = static_cast<std::uint32_t>(row + part.last.k);
        auto record =
            std::ranges::lower_bound(records, static_cast<std::uint32_t>(row + part.first.k), {}, &FilledSample::place);
        for (; record != records.end() && record->place <= end; ++record)
          keep_one(gap, {i, j, static_cast<std::int32_t>(record->place) - row}, *record);
      }
    }
  }
  void keep_one(const GapBox& gap, GridIndex node, FilledSample& record) const {
    const GridIndex& corner = gap.samples.first;
    const std::size_t at = gap.samples.at(node.i - corner.i, node.j - corner.j, node.k - corner.k);
    const float value = gap.samples.value[at];
    if (gap.state[at] == NodeState::wanted && std::isfinite(value))
      record.value = std::clamp(value, range_.min, range_.max);
  }

  BrickLayout layout_;
  ValueRange range_;
  FillWriter& writer_;
};

bool wants_any(const GapBox& gap, const GridBox& core) {
  const GridIndex& corner = gap.samples.first;
  for (std::int32_t i = core.first.i; i <= core.last.i; ++i)
    for (std::int32_t j = core.first.j; j <= core.last.j; ++j) {
      const std::size_t row = gap.samples.at(i - corner.i, j - corner.j, core.first.k - corner.k);
      for (std::int32_t k = 0; k <= core.last.k - core.first.k; ++k)
        if (gap.state[row + static_cast<std::size_t>(k)] == NodeState::wanted) return true;
    }
  return false;
}

}  // namespace

Result<void> fill_gaps(const GapSurvey& survey, const GapSolver& solver, const GapLimits& limits, FillWriter& writer,
                       int threads, Progress& progress, double from, double to) {
  const std::optional<Gaps> gaps = find_gaps(survey.shape(), survey.nodes, progress);
  if (!gaps) return Error{ErrorCode::cancelled, "cancelled"};
  const GapPlan plan = plan_gap_jobs(*gaps, limits);
  Keeper keeper(survey.volume, writer);
  FillShare share(progress, from, to, plan.jobs.size());
  std::vector<std::optional<Error>> errors(plan.jobs.size());
  const auto solve = [&](std::size_t number) -> Result<void> {
    const GapJob& job = plan.jobs[number];
    if (progress.cancelled()) return Error{ErrorCode::cancelled, "cancelled"};
    auto gap = read_gap(survey, *gaps, plan, job, job.wide ? limits.wide.margin : limits.margin, writer, progress);
    if (!gap) return std::move(gap).error();
    if (wants_any(*gap, job.core)) {
      if (auto solved = solver(*gap, progress); !solved) return solved;
      keeper.keep(*gap, job.core);
    }
    share.done();
    return {};
  };
  for (int wave = 0; wave < kWaves; ++wave) {
    const auto begin = std::ranges::lower_bound(plan.jobs, wave, {}, &GapJob::wave);
    const auto end = std::ranges::upper_bound(plan.jobs, wave, {}, &GapJob::wave);
    const auto first = static_cast<std::size_t>(begin - plan.jobs.begin());
    parallel_for(static_cast<std::size_t>(end - begin),
                 std::min(threads, wave == kSmallWave ? kSmallAtOnce : kBigAtOnce), [&](std::size_t n) {
                   if (auto solved = solve(first + n); !solved) errors[first + n] = std::move(solved).error();
                 });
    for (std::optional<Error>& error : errors)
      if (error) return *std::move(error);
  }
  return {};
}

}  // namespace geosis
