#include "engine/missing/plate/poisson_cycle.h"

#include <algorithm>
#include <utility>

namespace geosis {
namespace {

// Reciprocal roots of the Chebyshev polynomial of degree 2 over [0.3, 2]: of the eigenvalues of D^-1 L, those that the
// coarser level cannot see. Two sweeps shrink them all to 0.35; two sweeps of one damping, 0.8, only to 0.56.
constexpr float kDamping[2] = {0.5711f, 1.8215f};
constexpr int kCoarsestRounds = 16;
constexpr std::int32_t kSmallestCoarsened = 6;  // nodes an axis
constexpr float kWeakCoupling = 0.4f;           // of the strongest: such axes are coarsened later

/// sum_a c_a (u(x-e_a) + u(x+e_a))
struct NeighbourSum {
  const float* u;
  Vec3<float> weight;
  std::ptrdiff_t plane, row;

  float operator()(std::ptrdiff_t x) const {
    return weight.x * (u[x - plane] + u[x + plane]) + weight.y * (u[x - row] + u[x + row]) +
           weight.z * (u[x - 1] + u[x + 1]);
  }
};

/// The nodes of the other level that one node of an axis is tied to, with their weights.
struct Tie {
  std::int32_t node = 0;
  float weight = 0;
};
struct Ties {
  Tie tie[3];
  int count = 0;

  void add(std::int32_t node, std::int32_t nodes, float weight) {
    if (node >= 0 && node < nodes) tie[count++] = {node, weight};
  }
};

Ties fine_ties(std::int32_t coarse, std::int32_t fine_nodes, bool coarsened) {
  Ties ties;
  if (!coarsened) {
    ties.add(coarse, fine_nodes, 1);
    return ties;
  }
  ties.add(2 * coarse - 1, fine_nodes, 0.25f);
  ties.add(2 * coarse, fine_nodes, 0.5f);
  ties.add(2 * coarse + 1, fine_nodes, 0.25f);
  return ties;
}

Ties coarse_ties(std::int32_t fine, std::int32_t coarse_nodes, bool coarsened) {
  Ties ties;
  if (!coarsened) {
    ties.add(fine, coarse_nodes, 1);
  } else if (fine % 2 == 0) {
    ties.add(fine / 2, coarse_nodes, 1);
  } else {
    ties.add(fine / 2, coarse_nodes, 0.5f);
    ties.add(fine / 2 + 1, coarse_nodes, 0.5f);
  }
  return ties;
}

void add_row(const float* from, float weight, std::int32_t count, float* to) {
  for (std::int32_t k = 0; k < count; ++k) to[k] += weight * from[k];
}

}  // namespace

PoissonCycle::PoissonCycle(GridShape shape, std::vector<NodeState> state, Vec3d weights, const Progress& progress)
    : progress_(progress) {
  Level first;
  first.shape = shape;
  first.weight = {static_cast<float>(weights.x), static_cast<float>(weights.y), static_cast<float>(weights.z)};
  first.state = std::move(state);
  levels_.push_back(std::move(first));
  while (choose_axes(levels_.back()) && !progress_.cancelled()) {
    Level next = coarser(levels_.back());
    if (std::find(next.state.begin(), next.state.end(), NodeState::wanted) == next.state.end()) break;
    levels_.push_back(std::move(next));
  }
  for (Level& level : levels_) finish(level);
  for (std::size_t n = 1; n < levels_.size(); ++n)
    for (auto* array : {&levels_[n].right, &levels_[n].u, &levels_[n].spare}) array->resize(levels_[n].inverse.size());
}

/// Strongly coupled axes first; false when every axis is short.
bool PoissonCycle::choose_axes(Level& level) {
  float strongest = 0;
  for (int axis = 0; axis < 3; ++axis)
    if (level.shape[axis] >= kSmallestCoarsened) strongest = std::max(strongest, level.weight[axis]);
  for (int axis = 0; axis < 3; ++axis)
    level.coarsened[axis] = level.shape[axis] >= kSmallestCoarsened && level.weight[axis] >= kWeakCoupling * strongest;
  return strongest > 0;
}

PoissonCycle::Level PoissonCycle::coarser(const Level& fine) {
  Level coarse;
  const auto nodes = [&](int axis) { return fine.coarsened[axis] ? fine.shape[axis] / 2 + 1 : fine.shape[axis]; };
  coarse.shape = {nodes(0), nodes(1), nodes(2)};
  for (int axis = 0; axis < 3; ++axis) coarse.weight[axis] = fine.weight[axis] * (fine.coarsened[axis] ? 0.25f : 1);
  coarse.state.resize(static_cast<std::size_t>(coarse.shape.count()));
  // The last coarse layer may lie one step outside: it takes the state of the fine one.
  const auto place = [&](std::int32_t at, int axis) {
    return fine.coarsened[axis] ? std::min(2 * at, fine.shape[axis] - 1) : at;
  };
  std::size_t next = 0;
  for (std::int32_t i = 0; i < coarse.shape.inlines; ++i)
    for (std::int32_t j = 0; j < coarse.shape.crosslines; ++j)
      for (std::int32_t k = 0; k < coarse.shape.samples; ++k)
        coarse.state[next++] = fine.state[place(i, 0) * fine.plane() + place(j, 1) * fine.row() + place(k, 2)];
  return coarse;
}

/// Diagonals from the states.
void PoissonCycle::finish(Level& level) {
  level.diagonal.resize(level.state.size());
  level.inverse.resize(level.state.size());
  const std::ptrdiff_t steps[3] = {static_cast<std::ptrdiff_t>(level.plane()), static_cast<std::ptrdiff_t>(level.row()),
                                   1};
  for (std::size_t x = level.begin(); x < level.end(); ++x) {
    if (level.state[x] != NodeState::wanted) continue;
    float sum = 0;
    for (int axis = 0; axis < 3; ++axis)
      for (const std::ptrdiff_t step : {-steps[axis], steps[axis]})
        if (level.state[x + step] != NodeState::absent) sum += level.weight[axis];
    level.diagonal[x] = sum;
    level.inverse[x] = sum > 0 ? 1 / sum : 0;
  }
  level.state = {};
}

/// next = u + damping * D^-1 (right - L u). Zero where u and the inverse diagonal are.
void PoissonCycle::sweep(const Level& level, const float* right, const float* u, float damping, float* next) {
  const NeighbourSum around{u, level.weight, static_cast<std::ptrdiff_t>(level.plane()),
                            static_cast<std::ptrdiff_t>(level.row())};
  const float* inverse = level.inverse.data();
  const float keep = 1 - damping;
  const auto end = static_cast<std::ptrdiff_t>(level.end());
  for (auto x = static_cast<std::ptrdiff_t>(level.begin()); x < end; ++x)
    next[x] = keep * u[x] + damping * inverse[x] * (right[x] + around(x));
}

void PoissonCycle::residual(const Level& level, const float* right, const float* u, float* left) {
  const NeighbourSum around{u, level.weight, static_cast<std::ptrdiff_t>(level.plane()),
                            static_cast<std::ptrdiff_t>(level.row())};
  const float* inverse = level.inverse.data();
  const float* diagonal = level.diagonal.data();
  const auto end = static_cast<std::ptrdiff_t>(level.end());
  for (auto x = static_cast<std::ptrdiff_t>(level.begin()); x < end; ++x) {
    const float value = right[x] + around(x) - diagonal[x] * u[x];
    left[x] = inverse[x] > 0 ? value : 0;
  }
}

/// coarse.right = the fine residual, each coarse node taking half of its own and a quarter of either neighbour's.
void PoissonCycle::restrict_to(Level& coarse, const Level& fine, const float* left) {
  const std::int32_t length = fine.shape.samples;
  std::vector<float> sum(static_cast<std::size_t>(length) + 4);
  float* row = sum.data() + 1;
  for (std::int32_t i = 0; i < coarse.shape.inlines; ++i) {
    const Ties over_i = fine_ties(i, fine.shape.inlines, fine.coarsened[0]);
    for (std::int32_t j = 0; j < coarse.shape.crosslines; ++j) {
      const Ties over_j = fine_ties(j, fine.shape.crosslines, fine.coarsened[1]);
      std::fill(sum.begin(), sum.end(), 0.0f);
      for (int a = 0; a < over_i.count; ++a)
        for (int b = 0; b < over_j.count; ++b)
          add_row(left + over_i.tie[a].node * fine.plane() + over_j.tie[b].node * fine.row(),
                  over_i.tie[a].weight * over_j.tie[b].weight, length, row);
      const std::size_t start = i * coarse.plane() + j * coarse.row();
      float* right = coarse.right.data() + start;
      const float* inverse = coarse.inverse.data() + start;
      for (std::int32_t k = 0; k < coarse.shape.samples; ++k) {
        const float* middle = row + (fine.coarsened[2] ? 2 * k : k);
        const float value = fine.coarsened[2] ? 0.5f * middle[0] + 0.25f * (middle[-1] + middle[1]) : middle[0];
        right[k] = inverse[k] > 0 ? value : 0;
      }
    }
  }
}

/// u += the coarse correction, interpolated linearly, at wanted nodes.
void PoissonCycle::prolong(const Level& coarse, const Level& fine, float* u) {
  std::vector<float> sum(coarse.row() + 1);
  const std::int32_t length = fine.shape.samples;
  for (std::int32_t i = 0; i < fine.shape.inlines; ++i) {
    const Ties over_i = coarse_ties(i, coarse.shape.inlines, fine.coarsened[0]);
    for (std::int32_t j = 0; j < fine.shape.crosslines; ++j) {
      const Ties over_j = coarse_ties(j, coarse.shape.crosslines, fine.coarsened[1]);
      std::fill(sum.begin(), sum.end(), 0.0f);
      for (int a = 0; a < over_i.count; ++a)
        for (int b = 0; b < over_j.count; ++b)
          add_row(coarse.u.data() + over_i.tie[a].node * coarse.plane() + over_j.tie[b].node * coarse.row(),
                  over_i.tie[a].weight * over_j.tie[b].weight, coarse.shape.samples, sum.data());
      const std::size_t start = i * fine.plane() + j * fine.row();
      float* to = u + start;
      const float* inverse = fine.inverse.data() + start;
      if (!fine.coarsened[2]) {
        for (std::int32_t k = 0; k < length; ++k) to[k] += inverse[k] > 0 ? sum[k] : 0;
        continue;
      }
      for (std::int32_t k = 0; k < length; k += 2) to[k] += inverse[k] > 0 ? sum[k / 2] : 0;
      for (std::int32_t k = 1; k < length; k += 2) to[k] += inverse[k] > 0 ? 0.5f * (sum[k / 2] + sum[k / 2 + 1]) : 0;
    }
  }
}

void PoissonCycle::solve_coarsest(const Level& level, const float* right, float* u, float* spare) {
  std::fill(u, u + level.inverse.size(), 0.0f);
  for (int round = 0; round < kCoarsestRounds; ++round) {
    sweep(level, right, u, kDamping[0], spare);
    sweep(level, right, spare, kDamping[1], u);
  }
}

void PoissonCycle::cycle(std::size_t number, const float* right, float* u, float* spare) {
  const Level& level = levels_[number];
  if (number + 1 == levels_.size()) return solve_coarsest(level, right, u, spare);
  Level& coarse = levels_[number + 1];
  // The first sweep starts from zero.
  for (std::size_t x = level.begin(); x < level.end(); ++x) spare[x] = kDamping[0] * level.inverse[x] * right[x];
  sweep(level, right, spare, kDamping[1], u);
  residual(level, right, u, spare);
  if (progress_.cancelled()) return;
  restrict_to(coarse, level, spare);
  cycle(number + 1, coarse.right.data(), coarse.u.data(), coarse.spare.data());
  prolong(coarse, level, u);
  if (progress_.cancelled()) return;
  sweep(level, right, u, kDamping[1], spare);
  sweep(level, right, spare, kDamping[0], u);
}

void PoissonCycle::solve(std::span<const float> right, std::span<float> u, std::span<float> spare) {
  cycle(0, right.data(), u.data(), spare.data());
}

}  // namespace geosis
