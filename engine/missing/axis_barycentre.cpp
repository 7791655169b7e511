#include "engine/missing/axis_barycentre.h"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace geosis {
namespace {

constexpr double kHalfReliable = 0.4;  // step lengths

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

/// Members of `line`, a bit for each sample, are those of all lines.
void unite(std::span<std::uint64_t> all, std::span<const std::uint64_t> line) {
  for (std::size_t word = 0; word < all.size(); ++word) all[word] |= line[word];
}

/// For each inline and each crossline, the samples at which one of its traces is valid.
struct LineUnions {
  BitLines inlines, crosslines;
};
LineUnions unite_lines(GridShape shape, const BitLines& valid) {
  LineUnions unions{BitLines(static_cast<std::size_t>(shape.inlines), shape.samples),
                    BitLines(static_cast<std::size_t>(shape.crosslines), shape.samples)};
  std::size_t trace = 0;
  for (std::int32_t i = 0; i < shape.inlines; ++i) {
    for (std::int32_t j = 0; j < shape.crosslines; ++j, ++trace) {
      unite(unions.inlines.line(static_cast<std::size_t>(i)), valid.line(trace));
      unite(unions.crosslines.line(static_cast<std::size_t>(j)), valid.line(trace));
    }
  }
  return unions;
}

bool is_dead(std::span<const std::uint64_t> trace) {
  return std::ranges::none_of(trace, [](std::uint64_t word) { return word != 0; });
}

/// Nodes inside the outline that are valid or have a valid node on one of their lines. std::nullopt: all of them.
std::optional<BitLines> reached_nodes(GridShape shape, const BitLines& valid, const std::vector<std::uint8_t>& inside) {
  const LineUnions unions = unite_lines(shape, valid);
  BitLines reached(inside.size(), shape.samples);
  bool all = true;
  std::size_t trace = 0;
  for (std::int32_t i = 0; i < shape.inlines; ++i) {
    for (std::int32_t j = 0; j < shape.crosslines; ++j, ++trace) {
      if (!inside[trace]) continue;
      const auto line = reached.line(trace);
      if (is_dead(valid.line(trace))) {
        unite(line, unions.inlines.line(static_cast<std::size_t>(i)));
        unite(line, unions.crosslines.line(static_cast<std::size_t>(j)));
      } else {
        std::ranges::fill(line, ~std::uint64_t{0});
        line.back() = reached.last_word();
      }
      all = all && std::ranges::all_of(line.first(line.size() - 1), [](std::uint64_t w) { return ~w == 0; }) &&
            line.back() == reached.last_word();
    }
  }
  if (all) return std::nullopt;
  return reached;
}

GridIndex moved(GridIndex node, int axis, std::int32_t to) {
  node[axis] = to;
  return node;
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
  return static_cast<std::uint8_t>(254 / (1 + ratio * ratio * ratio) + 0.5);
}

AxisBarycentre::AxisBarycentre(const BrickViews& views, BitLines valid, Vec3d step_lengths,
                               const std::vector<std::uint8_t>& inside, int threads, const Progress& progress)
    : views_(views), step_lengths_(step_lengths), valid_(views.layout().shape(), std::move(valid), threads, progress) {
  if (auto reached = reached_nodes(valid_.shape(), valid_.along_k(), inside))
    reached_.emplace(valid_.shape(), *std::move(reached), threads, progress);
}

Estimate AxisBarycentre::at(GridIndex node) const {
  const Estimate first = from_valid(node);
  return is_met(first) ? first : from_reached(node);
}

Estimate AxisBarycentre::from_valid(GridIndex node) const {
  std::array<std::array<Estimate, 2>, 3> met;
  for (int axis = 0; axis < 3; ++axis) {
    const NodeSet::Neighbours next = valid_.neighbours(axis, node);
    auto& [before, after] = met[static_cast<std::size_t>(axis)];
    const double step = step_lengths_[axis];
    if (next.before >= 0) before = {views_.at(moved(node, axis, next.before)), step * (node[axis] - next.before)};
    if (next.after >= 0) after = {views_.at(moved(node, axis, next.after)), step * (next.after - node[axis])};
  }
  return combine(met);
}

Estimate AxisBarycentre::from_reached(GridIndex node) const {
  if (!reached_) return {};
  std::array<std::array<Estimate, 2>, 3> met;
  for (int axis = 0; axis < 3; ++axis) {
    const NodeSet::Neighbours next = reached_->neighbours(axis, node);
    const std::int32_t places[2] = {next.before, next.after};
    for (std::size_t side = 0; side < 2; ++side) {
      if (places[side] < 0) continue;
      // No node that is met here is valid: its line would have been met in the first step.
      Estimate source = from_valid(moved(node, axis, places[side]));
      source.distance += step_lengths_[axis] * (side == 0 ? node[axis] - places[side] : places[side] - node[axis]);
      met[static_cast<std::size_t>(axis)][side] = source;
    }
  }
  return combine(met);
}

}  // namespace geosis
