#pragma once

#include <algorithm>
#include <cstdint>

#include "engine/base/progress.h"
#include "engine/missing/gaps/gap_box.h"

namespace geosis::test {

/// Calls visit(i, j, k) for every node.
template <class Visit>
void for_each_node(GridShape shape, const Visit& visit) {
  for (std::int32_t i = 0; i < shape.inlines; ++i)
    for (std::int32_t j = 0; j < shape.crosslines; ++j)
      for (std::int32_t k = 0; k < shape.samples; ++k) visit(i, j, k);
}

/// A box with field(i, j, k) known everywhere.
template <class Field>
GapBox known_box(GridShape shape, const Field& field) {
  GapBox gap{{{}, shape, {}}, {}};
  for_each_node(shape, [&](int i, int j, int k) { gap.samples.value.push_back(static_cast<float>(field(i, j, k))); });
  gap.state.assign(gap.samples.value.size(), NodeState::known);
  return gap;
}

/// Takes the nodes where is_missing(i, j, k) away; they start from `start`.
template <class IsMissing>
void knock_out(GapBox& gap, const IsMissing& is_missing, float start = 0) {
  for_each_node(gap.samples.shape, [&](int i, int j, int k) {
    if (!is_missing(i, j, k)) return;
    gap.state[gap.samples.at(i, j, k)] = NodeState::wanted;
    gap.samples.value[gap.samples.at(i, j, k)] = start;
  });
}

template <class IsAbsent>
void remove(GapBox& gap, const IsAbsent& is_absent) {
  for_each_node(gap.samples.shape, [&](int i, int j, int k) {
    if (!is_absent(i, j, k)) return;
    gap.state[gap.samples.at(i, j, k)] = NodeState::absent;
    gap.samples.value[gap.samples.at(i, j, k)] = 0;
  });
}

/// A cube with a known margin of two nodes round a cubic gap of this size.
inline auto cube_gap(int size) {
  return [size](int i, int j, int k) {
    const auto inside = [size](int x) { return x >= 2 && x < size + 2; };
    return inside(i) && inside(j) && inside(k);
  };
}

/// The largest |value - field| over the wanted nodes.
template <class Field>
double largest_error(const GapBox& gap, const Field& field) {
  double largest = 0;
  for_each_node(gap.samples.shape, [&](int i, int j, int k) {
    const std::size_t at = gap.samples.at(i, j, k);
    if (gap.state[at] != NodeState::wanted) return;
    const double error = static_cast<double>(gap.samples.value[at]) - static_cast<double>(field(i, j, k));
    largest = std::max(largest, error < 0 ? -error : error);
  });
  return largest;
}

/// Says that it is cancelled from the given question on.
class CancelledAt final : public Progress {
 public:
  explicit CancelledAt(int question) : left_(question) {}
  void report(const char*, double) override {}
  bool cancelled() const override { return --left_ < 0; }

 private:
  mutable int left_;
};

}  // namespace geosis::test
