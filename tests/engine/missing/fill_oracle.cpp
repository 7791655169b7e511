#include "tests/engine/missing/fill_oracle.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace geosis::test {
namespace {

constexpr int kPasses = 6;  // the first one, and up to five that carry on

bool in_grid(GridShape shape, GridIndex n) {
  return n.i >= 0 && n.j >= 0 && n.k >= 0 && n.i < shape.inlines && n.j < shape.crosslines && n.k < shape.samples;
}

GridIndex step_along(GridIndex node, int axis, std::int32_t by) {
  node[axis] += by;
  return node;
}

/// Mean squared difference of valid samples `lag` apart, halved; nothing without pairs.
std::optional<double> half_difference(const ScalarField& field, int axis, std::int32_t lag) {
  double squares = 0;
  std::int64_t pairs = 0;
  for_each_node(field.shape, [&](GridIndex node) {
    const GridIndex other = step_along(node, axis, lag);
    if (!in_grid(field.shape, other) || std::isnan(field.at(node)) || std::isnan(field.at(other))) return;
    const double difference = double{field.at(other)} - field.at(node);
    squares += difference * difference;
    ++pairs;
  });
  if (pairs == 0) return std::nullopt;
  return squares / static_cast<double>(pairs) / 2;
}

double variance_of(const ScalarField& field) {
  double sum = 0, squares = 0;
  std::int64_t count = 0;
  for (const float value : field.samples) {
    if (std::isnan(value)) continue;
    sum += value;
    ++count;
  }
  for (const float value : field.samples)
    if (!std::isnan(value)) squares += (value - sum / double(count)) * (value - sum / double(count));
  return squares / static_cast<double>(count);
}

bool is_live(const ScalarField& field, std::int32_t i, std::int32_t j) {
  for (std::int32_t k = 0; k < field.shape.samples; ++k)
    if (!std::isnan(field.at({i, j, k}))) return true;
  return false;
}

/// Sides of the trace on which chosen(n) holds for some n of its line, its own place on both.
struct Sides {
  bool before = false, after = false;
  bool both() const { return before && after; }
  bool none() const { return !before && !after; }
};
template <class Chosen>
Sides sides_of(std::int32_t place, std::int32_t count, const Chosen& chosen) {
  Sides sides;
  for (std::int32_t n = 0; n < count; ++n) {
    if (!chosen(n)) continue;
    sides.before = sides.before || n <= place;
    sides.after = sides.after || n >= place;
  }
  return sides;
}

bool is_inside_by_live_lines(const ScalarField& field, std::int32_t i, std::int32_t j) {
  const Sides across = sides_of(i, field.shape.inlines, [&](std::int32_t n) { return is_live(field, n, j); });
  const Sides along = sides_of(j, field.shape.crosslines, [&](std::int32_t n) { return is_live(field, i, n); });
  return (across.both() && along.both()) || (across.both() && along.none()) || (across.none() && along.both());
}

bool is_inside(const ScalarField& field, std::int32_t i, std::int32_t j) {
  const auto on_inlines = [&](std::int32_t n) { return is_live(field, n, j); };
  const auto on_crosslines = [&](std::int32_t n) { return is_live(field, i, n); };
  if (!sides_of(i, field.shape.inlines, on_inlines).none() ||
      !sides_of(j, field.shape.crosslines, on_crosslines).none())
    return is_inside_by_live_lines(field, i, j);
  return sides_of(i, field.shape.inlines, [&](std::int32_t n) { return is_inside_by_live_lines(field, n, j); })
             .both() &&
         sides_of(j, field.shape.crosslines, [&](std::int32_t n) {
           return is_inside_by_live_lines(field, i, n);
         }).both();
}

/// Value and effective distance of the first source met on the way; distance -1 = none. Sources that are filled add
/// their own distance.
OracleNode walk(const std::vector<OracleNode>& sources, const ScalarField& grid, GridIndex node, int axis, int way,
                double step) {
  for (std::int32_t n = 1;; ++n) {
    const GridIndex other = step_along(node, axis, way * n);
    if (!in_grid(grid.shape, other)) return {};
    const OracleNode& source = sources[grid.index(other)];
    if (source.distance >= 0) return {source.value, source.distance + step * n};
  }
}

OracleNode barycentre(const std::vector<OracleNode>& sources, const ScalarField& grid, GridIndex node,
                      std::array<double, 3> steps) {
  double pair_weights = 0, pair_sum = 0, pair_w = 0, single_weights = 0, single_sum = 0, single_w = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const OracleNode below = walk(sources, grid, node, axis, -1, steps[static_cast<std::size_t>(axis)]);
    const OracleNode above = walk(sources, grid, node, axis, +1, steps[static_cast<std::size_t>(axis)]);
    if (below.distance > 0 && above.distance > 0) {
      const double w = 1 / below.distance + 1 / above.distance;
      const double linear =
          (below.value * above.distance + above.value * below.distance) / (below.distance + above.distance);
      pair_weights += w * w;
      pair_sum += w * w * linear;
      pair_w += w;
    }
    for (const OracleNode& sample : {below, above}) {
      if (sample.distance <= 0) continue;
      single_weights += 1 / (sample.distance * sample.distance);
      single_sum += sample.value / (sample.distance * sample.distance);
      single_w += 1 / sample.distance;
    }
  }
  if (pair_weights > 0) return {pair_sum / pair_weights, 1 / pair_w};
  if (single_weights > 0) return {single_sum / single_weights, 2 / single_w};
  return {};
}

double nearest_sample(const ScalarField& field, GridIndex node) {
  std::int64_t nearest = std::numeric_limits<std::int64_t>::max();
  for_each_node(field.shape, [&](GridIndex other) {
    if (std::isnan(field.at(other))) return;
    const std::int64_t i = other.i - node.i, j = other.j - node.j, k = other.k - node.k;
    nearest = std::min(nearest, i * i + j * j + k * k);
  });
  return std::sqrt(static_cast<double>(nearest));
}

}  // namespace

std::array<double, 3> measure_steps(const ScalarField& field) {
  const double variance = variance_of(field);
  if (!(variance > 0)) return {1, 1, 1};
  std::array<std::optional<double>, 3> steps;
  double largest = 0;
  for (int axis = 0; axis < 3; ++axis) {
    auto& step = steps[static_cast<std::size_t>(axis)];
    if (const auto near = half_difference(field, axis, 1))
      step = std::sqrt(*near / variance);
    else if (const auto far = half_difference(field, axis, 2))
      step = std::sqrt(*far / variance) / std::sqrt(2.0);
    largest = std::max(largest, step.value_or(0));
  }
  if (largest == 0) return {1, 1, 1};
  std::array<double, 3> result;
  for (std::size_t axis = 0; axis < 3; ++axis) result[axis] = std::max(steps[axis].value_or(largest), largest / 20);
  return result;
}

std::vector<OracleNode> fill_slowly(const ScalarField& field, std::array<double, 3> steps,
                                    std::optional<double> max_distance) {
  std::vector<OracleNode> sources(field.samples.size());
  for (std::size_t n = 0; n < sources.size(); ++n)
    if (!std::isnan(field.samples[n])) sources[n] = {field.samples[n], 0};
  ScalarField inside({field.shape.inlines, field.shape.crosslines, 1});
  for_each_node(inside.shape, [&](GridIndex trace) { inside.at(trace) = is_inside(field, trace.i, trace.j); });
  for (int pass = 0; pass < kPasses; ++pass) {
    const std::vector<OracleNode> before = sources;
    for_each_node(field.shape, [&](GridIndex node) {
      OracleNode& own = sources[field.index(node)];
      if (own.distance < 0 && inside.at({node.i, node.j, 0}) == 1) own = barycentre(before, field, node, steps);
    });
  }
  for_each_node(field.shape, [&](GridIndex node) {
    OracleNode& own = sources[field.index(node)];
    if (own.distance == 0) own.distance = -1;  // measured
    if (own.distance > 0 && max_distance && nearest_sample(field, node) > *max_distance) own.distance = -1;
  });
  return sources;
}

ScalarField filled_slowly(ScalarField field, const std::vector<OracleNode>& nodes) {
  for (std::size_t n = 0; n < nodes.size(); ++n)
    if (nodes[n].distance >= 0) field.samples[n] = static_cast<float>(nodes[n].value);
  return field;
}

}  // namespace geosis::test
