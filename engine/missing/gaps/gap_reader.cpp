#include "engine/missing/gaps/gap_reader.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <utility>

namespace geosis {
namespace {

bool contains(const GridBox& box, GridIndex node) {
  for (int axis = 0; axis < 3; ++axis)
    if (node[axis] < box.first[axis] || node[axis] > box.last[axis]) return false;
  return true;
}

class Reader {
 public:
  Reader(const GapSurvey& survey, const Gaps& gaps, const GapPlan& plan, const GapJob& job, FillWriter& writer)
      : survey_(survey), gaps_(gaps), plan_(plan), job_(job), writer_(writer) {}

  Result<GapBox> read(GridShape margin, const Progress& progress) {
    const GridBox box = grown(job_.solved, margin, survey_.shape());
    auto samples = read_box(survey_.volume, box);
    if (!samples) return std::move(samples).error();
    gap_.samples = *std::move(samples);
    gap_.wide = job_.wide;
    gap_.state.resize(gap_.samples.value.size());
    std::ranges::transform(gap_.samples.value, gap_.state.begin(),
                           [](float value) { return value == value ? NodeState::known : NodeState::absent; });
    for (std::int32_t i = box.first.i; i <= box.last.i; ++i) {
      if (progress.cancelled()) return Error{ErrorCode::cancelled, "cancelled"};
      for (std::int32_t j = box.first.j; j <= box.last.j; ++j) read_trace(i, j, box.first.k, box.last.k);
    }
    return std::move(gap_);
  }

 private:
  void read_trace(std::int32_t i, std::int32_t j, std::int32_t first_k, std::int32_t last_k) {
    const std::size_t trace = static_cast<std::size_t>(i) * survey_.shape().crosslines + j;
    const auto runs = gaps_.runs_of(trace);
    const auto from = std::ranges::lower_bound(runs, first_k, {}, &NodeRun::last);
    for (auto run = from; run != runs.end() && run->first <= last_k; ++run) {
      const auto number = gaps_.first_run[trace] + static_cast<std::size_t>(run - runs.begin());
      if (plan_.group_of[gaps_.gap_of[number]] == job_.group)
        read_run(i, j, std::max(run->first, first_k), std::min(run->last, last_k));
    }
  }
  /// Part by part, as the bricks cut the trace.
  void read_run(std::int32_t i, std::int32_t j, std::int32_t first, std::int32_t last) {
    const std::int32_t last_brick = std::max(0, (survey_.shape().samples - 2) / kBrickCells);
    while (first <= last) {
      const BrickRow row{i, j, std::min(first / kBrickCells, last_brick)};
      const std::int32_t end = std::min(last, row.first_k() + kBrickSamples - 1);
      const std::int32_t count = end - first + 1;
      const std::uint64_t bits = (count == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << count) - 1)
                                 << (first - row.first_k());
      survey_.barycentre.estimate(row, bits, estimates_);
      for (std::int32_t k = first; k <= end; ++k)
        put({i, j, k}, static_cast<float>(estimates_[static_cast<std::size_t>(k - row.first_k())].value));
      first = end + 1;
    }
  }
  void put(GridIndex node, float start) {
    const GridIndex& corner = gap_.samples.first;
    const std::size_t at = gap_.samples.at(node.i - corner.i, node.j - corner.j, node.k - corner.k);
    const FilledSample* decided = job_.wave_of(node) < job_.wave ? writer_.find(node) : nullptr;
    gap_.samples.value[at] = decided != nullptr ? decided->value : start;
    gap_.state[at] = decided != nullptr || !contains(job_.solved, node) ? NodeState::known : NodeState::wanted;
  }

  const GapSurvey& survey_;
  const Gaps& gaps_;
  const GapPlan& plan_;
  const GapJob& job_;
  FillWriter& writer_;
  GapBox gap_;
  AxisBarycentre::Row estimates_;
};

}  // namespace

Result<GapBox> read_gap(const GapSurvey& survey, const Gaps& gaps, const GapPlan& plan, const GapJob& job,
                        GridShape margin, FillWriter& writer, const Progress& progress) {
  return Reader(survey, gaps, plan, job, writer).read(margin, progress);
}

}  // namespace geosis
