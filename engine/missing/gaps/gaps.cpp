#include "engine/missing/gaps/gaps.h"

#include <algorithm>
#include <bit>
#include <numeric>

namespace geosis {
namespace {

/// Bits of a line that begin a run, and those that end one, word by word.
struct RunEnds {
  std::uint64_t first, last;
};
RunEnds run_ends(std::span<const std::uint64_t> line, std::size_t word) {
  const std::uint64_t bits = line[word];
  const std::uint64_t from_below = word == 0 ? 0 : line[word - 1] >> 63;
  const std::uint64_t from_above = word + 1 == line.size() ? 0 : line[word + 1] << 63;
  return {bits & ~(bits << 1 | from_below), bits & ~(bits >> 1 | from_above)};
}

void find_runs(const BitLines& nodes, Gaps& gaps) {
  const std::size_t traces = gaps.first_run.size() - 1;
  for (std::size_t trace = 0; trace < traces; ++trace) {
    std::uint32_t count = 0;
    for (std::size_t word = 0; word < nodes.words(); ++word)
      count += static_cast<std::uint32_t>(std::popcount(run_ends(nodes.line(trace), word).first));
    gaps.first_run[trace + 1] = gaps.first_run[trace] + count;
  }
  gaps.runs.resize(gaps.first_run[traces]);
  std::size_t begun = 0, ended = 0;
  for (std::size_t trace = 0; trace < traces; ++trace) {
    for (std::size_t word = 0; word < nodes.words(); ++word) {
      auto [first, last] = run_ends(nodes.line(trace), word);
      const auto k = static_cast<std::int32_t>(word * 64);
      for (; first != 0; first &= first - 1) gaps.runs[begun++].first = k + std::countr_zero(first);
      for (; last != 0; last &= last - 1) gaps.runs[ended++].last = k + std::countr_zero(last);
    }
  }
}

/// Union of runs; the root of a set is its first run. Until numbered, gap_of holds parents.
class Joiner {
 public:
  explicit Joiner(Gaps& gaps) : gaps_(gaps), parent_(gaps.gap_of) {
    parent_.resize(gaps.runs.size());
    std::iota(parent_.begin(), parent_.end(), 0u);
  }

  /// Runs of one trace with a single valid node between them.
  void join_along(std::size_t trace) {
    for (std::uint32_t run = gaps_.first_run[trace] + 1; run < gaps_.first_run[trace + 1]; ++run)
      if (gaps_.runs[run].first - gaps_.runs[run - 1].last <= 2) join(run, run - 1);
  }
  /// Runs of two traces that come within `reach` samples of each other.
  void join_across(std::size_t trace, std::size_t other, std::int32_t reach) {
    std::uint32_t a = gaps_.first_run[trace], b = gaps_.first_run[other];
    while (a < gaps_.first_run[trace + 1] && b < gaps_.first_run[other + 1]) {
      const NodeRun &run = gaps_.runs[a], &next = gaps_.runs[b];
      if (run.first <= next.last + reach && next.first <= run.last + reach) join(a, b);
      run.last < next.last ? ++a : ++b;
    }
  }
  /// Gives each set its number, in place: parents come before their children.
  std::uint32_t number() {
    for (std::uint32_t run = 0; run < parent_.size(); ++run) parent_[run] = parent_[parent_[run]];
    std::uint32_t gaps = 0;
    for (std::uint32_t run = 0; run < parent_.size(); ++run)
      parent_[run] = parent_[run] == run ? gaps++ : parent_[parent_[run]];
    return gaps;
  }

 private:
  std::uint32_t root(std::uint32_t run) {
    while (parent_[run] != run) run = parent_[run] = parent_[parent_[run]];
    return run;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    a = root(a);
    b = root(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

  const Gaps& gaps_;
  std::vector<std::uint32_t>& parent_;
};

void include(Gap& gap, std::int32_t i, std::int32_t j, const NodeRun& run) {
  const GridBox box{{i, j, run.first}, {i, j, run.last}};
  if (gap.nodes == 0) gap.box = box;
  for (int axis = 0; axis < 3; ++axis) {
    gap.box.first[axis] = std::min(gap.box.first[axis], box.first[axis]);
    gap.box.last[axis] = std::max(gap.box.last[axis], box.last[axis]);
  }
  gap.nodes += run.last - run.first + 1;
}

}  // namespace

std::optional<Gaps> find_gaps(GridShape shape, const BitLines& nodes, const Progress& progress) {
  const auto crosslines = static_cast<std::size_t>(shape.crosslines);
  Gaps gaps{shape, {}, {}, {}, {}};
  gaps.first_run.resize(static_cast<std::size_t>(shape.inlines) * crosslines + 1);
  find_runs(nodes, gaps);
  Joiner joiner(gaps);
  for (std::int32_t i = 0; i < shape.inlines; ++i) {
    if (progress.cancelled()) return std::nullopt;
    for (std::int32_t j = 0; j < shape.crosslines; ++j) {
      const std::size_t trace = static_cast<std::size_t>(i) * crosslines + static_cast<std::size_t>(j);
      joiner.join_along(trace);
      if (j >= 1) joiner.join_across(trace, trace - 1, 1);
      if (j >= 2) joiner.join_across(trace, trace - 2, 0);
      if (i >= 1) joiner.join_across(trace, trace - crosslines, 1);
      if (i >= 2) joiner.join_across(trace, trace - 2 * crosslines, 0);
      if (i >= 1 && j >= 1) joiner.join_across(trace, trace - crosslines - 1, 0);
      if (i >= 1 && j + 1 < shape.crosslines) joiner.join_across(trace, trace - crosslines + 1, 0);
    }
  }
  gaps.gaps.resize(joiner.number());
  std::size_t trace = 0;
  for (std::int32_t i = 0; i < shape.inlines; ++i)
    for (std::int32_t j = 0; j < shape.crosslines; ++j, ++trace)
      for (std::uint32_t run = gaps.first_run[trace]; run < gaps.first_run[trace + 1]; ++run)
        include(gaps.gaps[gaps.gap_of[run]], i, j, gaps.runs[run]);
  return gaps;
}

}  // namespace geosis
