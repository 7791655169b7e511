#include "engine/missing/steered_energy.h"

#include <algorithm>

namespace geosis {

/// The rows of one trace: taps of its neighbours' cubics, interpolated samples, and the terms. Rows have one zero
/// before the trace and two after it, for terms that reach a sample up or down.
struct TraceWorkspace {
  using Row = std::vector<float>;
  struct Taps {
    std::vector<std::int32_t> base;  // of the first of four samples, in the neighbour's trace
    std::array<Row, 4> weight;
  };

  explicit TraceWorkspace(std::int32_t samples) {
    const auto length = static_cast<std::size_t>(samples) + 3;
    for (Taps& t : taps) {
      t.base.assign(length, 0);
      for (Row& row : t.weight) row.assign(length, 0.0f);
    }
    for (Row& row : lateral) row.assign(length, 0.0f);
    for (Row& row : term) row.assign(length, 0.0f);
    own.assign(length, 0.0f);
  }

  std::array<Taps, neighbours> taps;
  std::array<Row, neighbours> lateral;  // f on the neighbours' reflectors; then what goes back there
  std::array<Row, SteeredEnergy::kTerms> term;
  Row own;  // f of the trace itself; then what goes back to it
};

namespace {

enum Term : std::size_t { ii, jj, kk, ij, ik, jk };

std::size_t trace_start(GridShape shape, std::int32_t i, std::int32_t j) {
  return (static_cast<std::size_t>(i) * shape.crosslines + j) * static_cast<std::size_t>(shape.samples);
}

bool has_trace(GridShape shape, std::int32_t i, std::int32_t j) {
  return i >= 0 && j >= 0 && i < shape.inlines && j < shape.crosslines;
}

/// Lagrange's cubic through the four samples around each depth, samples first ... end - 1 of the trace.
void aim(TraceWorkspace::Taps& taps, const float* depth, std::int32_t first, std::int32_t end, std::int32_t samples) {
  const std::int32_t last_base = std::max(samples - 4, 0);
  std::int32_t* const base = taps.base.data();
  float* const w0 = taps.weight[0].data();
  float* const w1 = taps.weight[1].data();
  float* const w2 = taps.weight[2].data();
  float* const w3 = taps.weight[3].data();
  for (std::int32_t k = first; k < end; ++k) {
    std::int32_t above = static_cast<std::int32_t>(depth[k]) - 1;
    above = above > 0 ? above : 0;
    above = above < last_base ? above : last_base;
    const float a = depth[k] - static_cast<float>(above), b = a - 1, c = a - 2, d = a - 3;
    base[k] = above;
    w0[k] = b * c * d * (-1.0f / 6);
    w1[k] = 0.5f * a * c * d;
    w2[k] = -0.5f * a * b * d;
    w3[k] = a * b * c * (1.0f / 6);
  }
}

void interpolate(const TraceWorkspace::Taps& taps, const float* trace, std::int32_t first, std::int32_t end,
                 float* row) {
  for (std::int32_t k = first; k < end; ++k) {
    const float* x = trace + taps.base[k];
    row[k] = taps.weight[0][k] * x[0] + taps.weight[1][k] * x[1] + taps.weight[2][k] * x[2] + taps.weight[3][k] * x[3];
  }
}

/// The transpose of interpolate().
template <bool kSquared>
void spread(const TraceWorkspace::Taps& taps, const float* row, std::int32_t first, std::int32_t end, float* trace) {
  for (std::int32_t k = first; k < end; ++k) {
    float* x = trace + taps.base[k];
    for (std::size_t t = 0; t < 4; ++t) {
      const float weight = taps.weight[t][k];
      x[t] += kSquared ? weight * weight * row[k] : weight * row[k];
    }
  }
}

/// Which nodes a sample depends on: whether all have a value, and whether one of them is wanted.
struct Reach {
  bool is_usable = false, is_wanted = false;
};

Reach reach_of(NodeState state) {
  return {state != NodeState::absent, state == NodeState::wanted};
}

Reach reach_of(const TraceWorkspace::Taps& taps, std::int32_t k, const NodeState* trace) {
  Reach reach{true, false};
  for (std::size_t t = 0; t < 4; ++t) {
    if (taps.weight[t][k] == 0) continue;
    const Reach one = reach_of(trace[taps.base[k] + static_cast<std::int32_t>(t)]);
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

  std::uint8_t terms(std::size_t n) const {
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

/// The six terms at samples first ... end - 1, times their weights, in place of 1 (they count) or 0.
void evaluate_terms(TraceWorkspace& work, const std::array<float, SteeredEnergy::kTerms>& weight, std::int32_t first,
                    std::int32_t end) {
  const float* f = work.own.data() + 1;
  const float* after_i = work.lateral[next_inline].data() + 1;
  const float* after_j = work.lateral[next_crossline].data() + 1;
  const float* before_i = work.lateral[previous_inline].data() + 1;
  const float* before_j = work.lateral[previous_crossline].data() + 1;
  const float* across = work.lateral[corner].data() + 1;
  float* t[SteeredEnergy::kTerms];
  for (std::size_t n = 0; n < SteeredEnergy::kTerms; ++n) t[n] = work.term[n].data() + 1;
  for (std::int32_t k = first; k < end; ++k) {
    const float slope_i = after_i[k] - f[k], slope_j = after_j[k] - f[k];
    t[ii][k] *= weight[ii] * (slope_i - (f[k] - before_i[k]));
    t[jj][k] *= weight[jj] * (slope_j - (f[k] - before_j[k]));
    t[kk][k] *= weight[kk] * ((f[k + 1] - f[k]) - (f[k] - f[k - 1]));
    t[ij][k] *= weight[ij] * ((across[k] - after_j[k]) - slope_i);
    t[ik][k] *= weight[ik] * ((after_i[k + 1] - f[k + 1]) - slope_i);
    t[jk][k] *= weight[jk] * ((after_j[k + 1] - f[k + 1]) - slope_j);
  }
}

/// What the terms pass back to the samples they were made of; squared: the squares of their parts.
template <bool kSquared>
void return_terms(TraceWorkspace& work, std::int32_t first, std::int32_t end) {
  constexpr float kMinus = kSquared ? 1.0f : -1.0f;
  constexpr float kMiddle = kSquared ? 4.0f : -2.0f;
  const float* t[SteeredEnergy::kTerms];
  for (std::size_t n = 0; n < SteeredEnergy::kTerms; ++n) t[n] = work.term[n].data() + 1;
  float* own = work.own.data() + 1;
  float* after_i = work.lateral[next_inline].data() + 1;
  float* after_j = work.lateral[next_crossline].data() + 1;
  float* before_i = work.lateral[previous_inline].data() + 1;
  float* before_j = work.lateral[previous_crossline].data() + 1;
  float* across = work.lateral[corner].data() + 1;
  for (std::int32_t k = first - 1; k <= end; ++k) {
    const float slope_k = t[ik][k] + t[jk][k];
    own[k] = kMiddle * (t[ii][k] + t[jj][k] + t[kk][k]) + t[ij][k] + slope_k;
  }
  // A term at k reaches k - 1 and k + 1, and no term lies outside first ... end - 1.
  for (std::int32_t k = first - 1; k < end; ++k) own[k] += t[kk][k + 1];
  for (std::int32_t k = first; k <= end; ++k) {
    own[k] += t[kk][k - 1] + kMinus * (t[ik][k - 1] + t[jk][k - 1]);
    after_i[k] = t[ii][k] + kMinus * (t[ij][k] + t[ik][k]) + t[ik][k - 1];
    after_j[k] = t[jj][k] + kMinus * (t[ij][k] + t[jk][k]) + t[jk][k - 1];
    before_i[k] = t[ii][k];
    before_j[k] = t[jj][k];
    across[k] = t[ij][k];
  }
}

}  // namespace

SteeredEnergy::SteeredEnergy(std::span<const NodeState> state, const SteeredPaths& paths, const Vec3d& step_lengths)
    : state_(state), paths_(paths), shape_(paths.shape) {
  const double least = std::min({step_lengths.x, step_lengths.y, step_lengths.z});
  double curvature[3];
  for (int axis = 0; axis < 3; ++axis) {
    const double ratio = least / step_lengths[axis];
    curvature[axis] = ratio * ratio;
  }
  constexpr int kAxes[kTerms][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};
  for (std::size_t term = 0; term < kTerms; ++term) {
    const auto [a, b] = kAxes[term];
    weight_[term] = static_cast<float>((a == b ? 1 : 2) * curvature[a] * curvature[b]);
  }
  find_terms();
}

void SteeredEnergy::find_terms() {
  terms_.assign(state_.size(), 0);
  range_.assign(static_cast<std::size_t>(shape_.inlines) * shape_.crosslines, {});
  TraceWorkspace work(shape_.samples);
  for (std::int32_t i = 0; i < shape_.inlines; ++i) {
    for (std::int32_t j = 0; j < shape_.crosslines; ++j) {
      const std::size_t here = trace_start(shape_, i, j);
      TraceReach reach(shape_.samples);
      for (std::int32_t k = 0; k < shape_.samples; ++k) reach.own[k + 1] = reach_of(state_[here + k]);
      for (std::size_t n = 0; n < neighbours; ++n) {
        const std::int32_t to_i = i + kTraceSteps[n].inlines, to_j = j + kTraceSteps[n].crosslines;
        if (!has_trace(shape_, to_i, to_j)) continue;
        aim(work.taps[n], &paths_.depth[n][here], 0, shape_.samples, shape_.samples);
        const NodeState* trace = &state_[trace_start(shape_, to_i, to_j)];
        for (std::int32_t k = 0; k < shape_.samples; ++k) reach.lateral[n][k + 1] = reach_of(work.taps[n], k, trace);
      }
      Range& range = range_[static_cast<std::size_t>(i) * shape_.crosslines + j];
      for (std::int32_t k = 0; k < shape_.samples; ++k) {
        terms_[here + k] = reach.terms(static_cast<std::size_t>(k) + 1);
        if (terms_[here + k] == 0) continue;
        if (range.end == 0) range.first = k;
        range.end = k + 1;
      }
    }
  }
}

template <bool kSquared>
void SteeredEnergy::add_trace(const float* x, float* result, std::int32_t i, std::int32_t j,
                              TraceWorkspace& work) const {
  const auto [first, end] = range_[static_cast<std::size_t>(i) * shape_.crosslines + j];
  if (end == 0) return;
  const std::int32_t reached = std::min(end + 1, shape_.samples);  // mixed terms look one sample further down
  const std::size_t here = trace_start(shape_, i, j);
  for (std::size_t n = 0; n < kTerms; ++n) {
    float* term = work.term[n].data() + 1;
    term[first - 1] = term[end] = 0;
    for (std::int32_t k = first; k < end; ++k) term[k] = static_cast<float>(terms_[here + k] >> n & 1);
  }
  std::array<std::size_t, neighbours> there{};
  std::array<bool, neighbours> has{};
  for (std::size_t n = 0; n < neighbours; ++n) {
    const std::int32_t to_i = i + kTraceSteps[n].inlines, to_j = j + kTraceSteps[n].crosslines;
    has[n] = has_trace(shape_, to_i, to_j);
    if (!has[n]) continue;
    there[n] = trace_start(shape_, to_i, to_j);
    aim(work.taps[n], &paths_.depth[n][here], first, reached, shape_.samples);
    if constexpr (!kSquared) interpolate(work.taps[n], x + there[n], first, reached, work.lateral[n].data() + 1);
  }
  if constexpr (kSquared) {
    for (std::size_t n = 0; n < kTerms; ++n) {
      for (std::int32_t k = first; k < end; ++k) work.term[n][k + 1] *= weight_[n];
    }
  } else {
    float* own = work.own.data() + 1;
    for (std::int32_t k = std::max(first - 1, 0); k < reached; ++k) own[k] = x[here + k];
    evaluate_terms(work, weight_, first, end);
  }
  return_terms<kSquared>(work, first, end);
  for (std::size_t n = 0; n < neighbours; ++n) {
    if (has[n]) spread<kSquared>(work.taps[n], work.lateral[n].data() + 1, first, reached, result + there[n]);
  }
  const float* own = work.own.data() + 1;
  for (std::int32_t k = std::max(first - 1, 0); k < reached; ++k) result[here + k] += own[k];
}

void SteeredEnergy::gradient(std::span<const float> x, std::span<float> result) const {
  std::fill(result.begin(), result.end(), 0.0f);
  TraceWorkspace work(shape_.samples);
  for (std::int32_t i = 0; i < shape_.inlines; ++i) {
    for (std::int32_t j = 0; j < shape_.crosslines; ++j) add_trace<false>(x.data(), result.data(), i, j, work);
  }
  for (std::size_t n = 0; n < state_.size(); ++n) {
    if (state_[n] != NodeState::wanted) result[n] = 0;
  }
}

void SteeredEnergy::diagonal(std::span<float> result) const {
  std::fill(result.begin(), result.end(), 0.0f);
  TraceWorkspace work(shape_.samples);
  for (std::int32_t i = 0; i < shape_.inlines; ++i) {
    for (std::int32_t j = 0; j < shape_.crosslines; ++j) add_trace<true>(nullptr, result.data(), i, j, work);
  }
}

}  // namespace geosis
