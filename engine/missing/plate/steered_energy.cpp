#include "engine/missing/plate/steered_energy.h"

#include <algorithm>
#include <initializer_list>

namespace geosis {

namespace {

std::size_t trace_start(GridShape shape, std::int32_t i, std::int32_t j) {
  return (static_cast<std::size_t>(i) * shape.crosslines + j) * static_cast<std::size_t>(shape.samples);
}

constexpr std::array<Neighbour, neighbours> kNeighbours = {next_inline, previous_inline, next_crossline,
                                                           previous_crossline, corner};

bool has_neighbour(GridShape shape, std::int32_t i, std::int32_t j, Neighbour n) {
  i += kTraceSteps[n].inlines;
  j += kTraceSteps[n].crosslines;
  return i >= 0 && j >= 0 && i < shape.inlines && j < shape.crosslines;
}

std::size_t neighbour_start(GridShape shape, std::int32_t i, std::int32_t j, Neighbour n) {
  return trace_start(shape, i + kTraceSteps[n].inlines, j + kTraceSteps[n].crosslines);
}

/// Which nodes a sample depends on: whether all have a value, and whether one of them is wanted.
struct Reach {
  bool is_usable = false, is_wanted = false;
};

Reach reach_of(NodeState state) {
  return {state != NodeState::absent, state == NodeState::wanted};
}

Reach reach_of(const TraceTerms& work, Neighbour n, std::int32_t k, const NodeState* trace) {
  Reach reach{true, false};
  for (std::size_t t = 0; t < 4; ++t) {
    if (work.factor(n, k, t) == 0) continue;
    const Reach one = reach_of(trace[work.base(n, k) + static_cast<std::int32_t>(t)]);
    reach.is_usable &= one.is_usable;
    reach.is_wanted |= one.is_wanted;
  }
  return reach;
}

bool counts(std::initializer_list<Reach> parts) {
  bool is_wanted = false;
  for (const Reach& part : parts) {
    if (!part.is_usable) return false;
    is_wanted |= part.is_wanted;
  }
  return is_wanted;
}

/// Reach of a trace's samples and of their neighbours, [0] being a sample above the trace, which nobody can use.
struct TraceReach {
  explicit TraceReach(std::int32_t samples) : own(static_cast<std::size_t>(samples) + 2) {
    for (auto& row : lateral) row.resize(own.size());
  }
  std::vector<Reach> own;
  std::array<std::vector<Reach>, neighbours> lateral;

  std::uint8_t set_at(std::size_t n) const {
    const auto& next_i = lateral[next_inline];
    const auto& next_j = lateral[next_crossline];
    const auto bit = [](bool is_set, Term term) { return is_set ? 1u << term : 0u; };
    return static_cast<std::uint8_t>(bit(counts({lateral[previous_inline][n], own[n], next_i[n]}), ii) |
                                     bit(counts({lateral[previous_crossline][n], own[n], next_j[n]}), jj) |
                                     bit(counts({own[n - 1], own[n], own[n + 1]}), kk) |
                                     bit(counts({own[n], next_i[n], next_j[n], lateral[corner][n]}), ij) |
                                     bit(counts({own[n], next_i[n], own[n + 1], next_i[n + 1]}), ik) |
                                     bit(counts({own[n], next_j[n], own[n + 1], next_j[n + 1]}), jk));
  }
};

}  // namespace

SteeredEnergy::SteeredEnergy(std::span<const NodeState> state, const SteeredPaths& paths, const Vec3d& step_lengths)
    : state_(state), paths_(paths), shape_(paths.shape) {
  const double least = std::min({step_lengths.x, step_lengths.y, step_lengths.z});
  double curvature[3];
  for (int axis = 0; axis < 3; ++axis) {
    const double ratio = least / step_lengths[axis];
    curvature[axis] = ratio * ratio;
  }
  constexpr int kAxes[terms][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};
  for (std::size_t term = 0; term < terms; ++term) {
    const auto [a, b] = kAxes[term];
    weight_[term] = static_cast<float>((a == b ? 1 : 2) * curvature[a] * curvature[b]);
  }
  find_terms();
}

void SteeredEnergy::find_terms() {
  terms_.assign(state_.size(), 0);
  range_.assign(static_cast<std::size_t>(shape_.inlines) * shape_.crosslines, {});
  TraceTerms work(shape_.samples);
  for (std::int32_t i = 0; i < shape_.inlines; ++i) {
    for (std::int32_t j = 0; j < shape_.crosslines; ++j) {
      const std::size_t here = trace_start(shape_, i, j);
      TraceReach reach(shape_.samples);
      for (std::int32_t k = 0; k < shape_.samples; ++k) reach.own[k + 1] = reach_of(state_[here + k]);
      for (const Neighbour n : kNeighbours) {
        if (!has_neighbour(shape_, i, j, n)) continue;
        work.aim(n, &paths_.depth[n][here], 0, shape_.samples);
        const NodeState* trace = &state_[neighbour_start(shape_, i, j, n)];
        for (std::int32_t k = 0; k < shape_.samples; ++k) reach.lateral[n][k + 1] = reach_of(work, n, k, trace);
      }
      Range& range = range_[static_cast<std::size_t>(i) * shape_.crosslines + j];
      for (std::int32_t k = 0; k < shape_.samples; ++k) {
        terms_[here + k] = reach.set_at(static_cast<std::size_t>(k) + 1);
        if (terms_[here + k] == 0) continue;
        if (range.end == 0) range.first = k;
        range.end = k + 1;
      }
    }
  }
}

template <class Task>
void SteeredEnergy::for_each_trace(const Task& task) const {
  TraceTerms work(shape_.samples);
  for (std::int32_t i = 0; i < shape_.inlines; ++i) {
    for (std::int32_t j = 0; j < shape_.crosslines; ++j) {
      const auto [first, end] = range_[static_cast<std::size_t>(i) * shape_.crosslines + j];
      if (end == 0) continue;
      const std::size_t here = trace_start(shape_, i, j);
      work.select(&terms_[here], first, end);
      for (const Neighbour n : kNeighbours) {
        if (has_neighbour(shape_, i, j, n)) work.aim(n, &paths_.depth[n][here]);
      }
      task(work, i, j);
    }
  }
}

void SteeredEnergy::gradient(std::span<const float> x, std::span<float> result) const {
  std::fill(result.begin(), result.end(), 0.0f);
  for_each_trace([&](TraceTerms& work, std::int32_t i, std::int32_t j) {
    const std::size_t here = trace_start(shape_, i, j);
    work.load_own(&x[here]);
    for (const Neighbour n : kNeighbours) {
      if (has_neighbour(shape_, i, j, n)) work.load_neighbour(n, &x[neighbour_start(shape_, i, j, n)]);
    }
    work.evaluate(weight_);
    work.give_back();
    work.store_own(&result[here]);
    for (const Neighbour n : kNeighbours) {
      if (has_neighbour(shape_, i, j, n)) work.store_neighbour(n, &result[neighbour_start(shape_, i, j, n)]);
    }
  });
  for (std::size_t n = 0; n < state_.size(); ++n) {
    if (state_[n] != NodeState::wanted) result[n] = 0;
  }
}

void SteeredEnergy::diagonal(std::span<float> result) const {
  std::fill(result.begin(), result.end(), 0.0f);
  for_each_trace([&](TraceTerms& work, std::int32_t i, std::int32_t j) {
    work.give_back_squares(weight_);
    work.store_own(&result[trace_start(shape_, i, j)]);
    for (const Neighbour n : kNeighbours) {
      if (has_neighbour(shape_, i, j, n)) work.store_neighbour(n, &result[neighbour_start(shape_, i, j, n)]);
    }
  });
}

}  // namespace geosis
