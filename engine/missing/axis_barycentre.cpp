#include "engine/missing/axis_barycentre.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <utility>

namespace geosis {
namespace {

constexpr double kHalfReliable = 0.4;  // step lengths
constexpr int kMostRounds = 6;         // three are needed

/// What one axis contributes.
struct AxisShare {
  double weight = 0, value = 0, inverse_distance = 0;
};

AxisShare pair_share(const Estimate& before, const Estimate& after) {
  const double w = 1 / before.distance, v = 1 / after.distance;
  return {(w + v) * (w + v), (w * before.value + v * after.value) / (w + v), w + v};
}

AxisShare single_share(const Estimate& sample) {
  const double w = 1 / sample.distance;
  return {w * w, sample.value, w};
}

bool is_met(const Estimate& sample) {
  return sample.distance >= 0;
}

template <class Visit>
void for_each_bit(std::uint64_t bits, const Visit& visit) {
  for (; bits != 0; bits &= bits - 1) visit(std::countr_zero(bits));
}

/// Adds the members of a line, a bit for each sample, to those of another one.
void unite(std::span<std::uint64_t> all, std::span<const std::uint64_t> line) {
  for (std::size_t word = 0; word < all.size(); ++word) all[word] |= line[word];
}

/// For each inline and each crossline, the samples at which one of its traces has a member.
struct LineUnions {
  BitLines inlines, crosslines;
};
LineUnions unite_lines(GridShape shape, const BitLines& members) {
  LineUnions unions{BitLines(static_cast<std::size_t>(shape.inlines), shape.samples),
                    BitLines(static_cast<std::size_t>(shape.crosslines), shape.samples)};
  std::size_t trace = 0;
  for (std::int32_t i = 0; i < shape.inlines; ++i) {
    for (std::int32_t j = 0; j < shape.crosslines; ++j, ++trace) {
      unite(unions.inlines.line(static_cast<std::size_t>(i)), members.line(trace));
      unite(unions.crosslines.line(static_cast<std::size_t>(j)), members.line(trace));
    }
  }
  return unions;
}

/// Nodes inside the outline that are members or have one on their lines.
BitLines reach_from(GridShape shape, const BitLines& members, const std::vector<std::uint8_t>& inside) {
  const LineUnions unions = unite_lines(shape, members);
  BitLines reached(inside.size(), shape.samples);
  std::size_t trace = 0;
  for (std::int32_t i = 0; i < shape.inlines; ++i) {
    for (std::int32_t j = 0; j < shape.crosslines; ++j, ++trace) {
      if (!inside[trace]) continue;
      const auto line = reached.line(trace);
      if (std::ranges::any_of(members.line(trace), [](std::uint64_t word) { return word != 0; })) {
        std::ranges::fill(line, ~std::uint64_t{0});
        line.back() = reached.last_word();
      } else {
        unite(line, unions.inlines.line(static_cast<std::size_t>(i)));
        unite(line, unions.crosslines.line(static_cast<std::size_t>(j)));
      }
    }
  }
  return reached;
}

/// What rounds 1, 2, ... reach, without the last one, which reaches all that is inside.
std::vector<BitLines> reach_in_rounds(GridShape shape, const BitLines& valid, const std::vector<std::uint8_t>& inside) {
  const auto traces = static_cast<std::uint64_t>(std::ranges::count(inside, 1));
  const std::uint64_t all = traces * static_cast<std::uint64_t>(shape.samples);
  std::vector<BitLines> rounds;
  for (int round = 0; round < kMostRounds; ++round) {
    BitLines reached = reach_from(shape, rounds.empty() ? valid : rounds.back(), inside);
    if (reached.count() == all) break;
    rounds.push_back(std::move(reached));
  }
  return rounds;
}

}  // namespace

Estimate combine(const std::array<std::array<Estimate, 2>, 3>& met) {
  bool pairs = false;
  for (const auto& [before, after] : met) pairs = pairs || (is_met(before) && is_met(after));
  double weight = 0, sum = 0, inverse_distance = 0;
  const auto take = [&](const AxisShare& share) {
    weight += share.weight;
    sum += share.weight * share.value;
    inverse_distance += share.inverse_distance;
  };
  for (const auto& [before, after] : met) {
    if (pairs && is_met(before) && is_met(after)) take(pair_share(before, after));
    if (!pairs && is_met(before)) take(single_share(before));
    if (!pairs && is_met(after)) take(single_share(after));
  }
  if (weight == 0) return {};
  return {sum / weight, (pairs ? 1 : 2) / inverse_distance};
}

std::uint8_t reliability_of(double distance) {
  const double ratio = distance / kHalfReliable;
  return static_cast<std::uint8_t>(std::floor(254 / (1 + ratio * ratio * ratio) + 0.5));
}

/// What the nodes of a row met. Values and distances are left unset where nothing was met: there are many rows, and
/// most have few nodes.
struct AxisBarycentre::Met {
  struct Side {
    double value[kBrickSamples], distance[kBrickSamples];
    std::uint64_t nodes = 0;  ///< for which they hold
  };
  Side side[3][2];  ///< [axis][before, after]

  void add(int axis, int way, int k, Estimate estimate) {
    Side& own = side[axis][way < 0 ? 0 : 1];
    own.value[k] = estimate.value;
    own.distance[k] = estimate.distance;
    own.nodes |= std::uint64_t{1} << k;
  }
  std::uint64_t any() const {
    std::uint64_t nodes = 0;
    for (const auto& axis : side) nodes |= axis[0].nodes | axis[1].nodes;
    return nodes;
  }
  Estimate combined(int k) const {
    std::array<std::array<Estimate, 2>, 3> met;
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (std::size_t way = 0; way < 2; ++way)
        if (const Side& own = side[axis][way]; (own.nodes >> k & 1) != 0)
          met[axis][way] = {own.value[k], own.distance[k]};
    return combine(met);
  }
};

AxisBarycentre::AxisBarycentre(const BrickViews& views, const BitLines& valid, Vec3d step_lengths,
                               const std::vector<std::uint8_t>& inside)
    : views_(views),
      valid_(valid),
      shape_(views.layout().shape()),
      step_lengths_(step_lengths),
      reached_(reach_in_rounds(shape_, valid, inside)) {}

void AxisBarycentre::estimate(const BrickRow& row, std::uint64_t nodes, Row& estimates) const {
  std::uint64_t left = nodes & ~from_valid(row, nodes, estimates);
  for (std::size_t round = 0; left != 0 && round < reached_.size(); ++round)
    left &= ~from_reached(reached_[round], row, left, estimates);
}

/// Steps from trace to trace until every node of the row has met a member, or the volume ends:
/// take(the other row, the nodes that meet their member there, steps).
template <class Take>
void AxisBarycentre::walk(const BrickRow& row, int axis, int way, std::uint64_t nodes, const BitLines& members,
                          const Take& take) const {
  BrickRow other = row;
  std::int32_t& place = axis == 0 ? other.i : other.j;
  const std::int32_t count = std::min(kBrickSamples, shape_.samples - row.first_k());
  std::int32_t steps = 1;
  for (place += way; place >= 0 && place < shape_[axis] && nodes != 0; place += way, ++steps) {
    const std::uint64_t met = nodes & members.bits(trace(other.i, other.j), row.first_k(), count);
    if (met == 0) continue;
    take(other, met, steps);
    nodes ^= met;
  }
}

std::uint64_t AxisBarycentre::from_valid(const BrickRow& row, std::uint64_t nodes, Row& estimates) const {
  Met met;
  for (int axis = 0; axis < 2; ++axis) {
    for (const int way : {-1, 1}) {
      walk(row, axis, way, nodes, valid_, [&](const BrickRow& other, std::uint64_t found, std::int32_t steps) {
        const float* samples = views_.row(other.i, other.j, other.brick_k);
        for_each_bit(found, [&](int k) { met.add(axis, way, k, {samples[k], step_lengths_[axis] * steps}); });
      });
    }
  }
  std::int32_t before = -1, after = -1;
  float sample_before = 0, sample_after = 0;
  bool known = false;
  for_each_bit(nodes, [&](int k) {
    const std::int32_t node = row.first_k() + k;
    if (!known || (after >= 0 && node > after)) {  // neighbours in a gap have the same ends
      const std::size_t line = trace(row.i, row.j);
      before = valid_.before(line, node);
      after = valid_.after(line, node);
      if (before >= 0) sample_before = views_.at({row.i, row.j, before});
      if (after >= 0) sample_after = views_.at({row.i, row.j, after});
      known = true;
    }
    if (before >= 0) met.add(2, -1, k, {sample_before, step_lengths_[2] * (node - before)});
    if (after >= 0) met.add(2, +1, k, {sample_after, step_lengths_[2] * (after - node)});
  });
  for_each_bit(met.any(), [&](int k) { estimates[static_cast<std::size_t>(k)] = met.combined(k); });
  return met.any();
}

// No node that is met here is valid: its line would have been met in the first round.
std::uint64_t AxisBarycentre::from_reached(const BitLines& reached, const BrickRow& row, std::uint64_t nodes,
                                           Row& estimates) const {
  Met met;
  Row source;
  for (int axis = 0; axis < 2; ++axis) {
    for (const int way : {-1, 1}) {
      walk(row, axis, way, nodes, reached, [&](const BrickRow& other, std::uint64_t found, std::int32_t steps) {
        estimate(other, found, source);
        for_each_bit(found, [&](int k) {
          const Estimate& own = source[static_cast<std::size_t>(k)];
          met.add(axis, way, k, {own.value, own.distance + step_lengths_[axis] * steps});
        });
      });
    }
  }
  for_each_bit(nodes, [&](int k) {
    const std::int32_t node = row.first_k() + k;
    const std::size_t line = trace(row.i, row.j);
    for (const std::int32_t end : {reached.before(line, node), reached.after(line, node)}) {
      if (end < 0) continue;
      const Estimate own = estimate_one({row.i, row.j, end});
      met.add(2, end - node, k, {own.value, own.distance + step_lengths_[2] * std::abs(end - node)});
    }
  });
  for_each_bit(met.any(), [&](int k) { estimates[static_cast<std::size_t>(k)] = met.combined(k); });
  return met.any();
}

Estimate AxisBarycentre::estimate_one(GridIndex node) const {
  const BrickRow row{node.i, node.j, std::min(node.k / kBrickCells, views_.layout().grid().samples - 1)};
  Row estimates;
  const int k = node.k - row.first_k();
  estimate(row, std::uint64_t{1} << k, estimates);
  return estimates[static_cast<std::size_t>(k)];
}

}  // namespace geosis
