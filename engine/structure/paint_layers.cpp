#include "engine/structure/paint_layers.h"

#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <queue>
#include <utility>

#include "engine/base/parallel.h"

namespace geosis {
namespace {

constexpr float kCostOfAnyLink = 0.02f;
constexpr std::size_t kTracesBetweenLooks = 256;  // whether it is cancelled

/// A trace's neighbour, and the link between them.
struct Neighbour {
  std::size_t trace, link;
  LinkAxis axis;
  bool is_next;  ///< the link leads from the trace to the neighbour
};

template <class Visit>
void each_neighbour(GridShape shape, std::size_t trace, const Visit& visit) {
  const auto crosslines = static_cast<std::size_t>(shape.crosslines);
  const std::size_t i = trace / crosslines, j = trace % crosslines;
  if (i > 0) visit(Neighbour{trace - crosslines, trace - crosslines, LinkAxis::inline_, false});
  if (i + 1 < static_cast<std::size_t>(shape.inlines)) {
    visit(Neighbour{trace + crosslines, trace, LinkAxis::inline_, true});
  }
  if (j > 0) visit(Neighbour{trace - 1, trace - 1, LinkAxis::crossline, false});
  if (j + 1 < crosslines) visit(Neighbour{trace + 1, trace, LinkAxis::crossline, true});
}

float cost_of(const PaintOrder& order, const Neighbour& neighbour) {
  return order.link_cost[static_cast<std::size_t>(neighbour.axis)][neighbour.link];
}

void fill_costs(const DipField& field, int threads, PaintOrder& order) {
  const auto count = static_cast<double>(field.agreements()) * 255;
  for (const LinkAxis axis : kLinkAxes) {
    auto& cost = order.link_cost[static_cast<std::size_t>(axis)];
    cost.resize(field.trace_count());
    parallel_for(static_cast<std::size_t>(field.shape().inlines), threads, [&](std::size_t i) {
      const auto crosslines = static_cast<std::size_t>(field.shape().crosslines);
      for (std::size_t t = i * crosslines; t < (i + 1) * crosslines; ++t) {
        std::int64_t sum = 0;
        const std::uint8_t* agreement = field.agreements(t, axis);
        for (std::int32_t m = 0; m < field.agreements(); ++m) sum += agreement[m];
        cost[t] = kCostOfAnyLink + 1 - static_cast<float>(static_cast<double>(sum) / count);
      }
    });
  }
}

/// The trace nearest to the middle with a link that agrees at all; the middle one if there is none.
std::size_t reference_trace(const DipField& field, const PaintOrder& order) {
  const GridShape shape = field.shape();
  const std::int32_t middle_i = shape.inlines / 2, middle_j = shape.crosslines / 2;
  std::size_t best = field.trace_of(middle_i, middle_j);
  std::int64_t least = std::numeric_limits<std::int64_t>::max();
  for (std::int32_t i = 0; i < shape.inlines; ++i) {
    for (std::int32_t j = 0; j < shape.crosslines; ++j) {
      const std::int64_t di = i - middle_i, dj = j - middle_j, away = di * di + dj * dj;
      if (away >= least) continue;
      const std::size_t trace = field.trace_of(i, j);
      bool has_data = false;
      each_neighbour(shape, trace, [&](const Neighbour& n) { has_data |= cost_of(order, n) < 1; });
      if (!has_data) continue;
      least = away;
      best = trace;
    }
  }
  return best;
}

/// Carries all layers of one trace to a neighbour and adds them, times weight, to `sum`.
void carry(const DipField& field, const Neighbour& from, const float* depth, std::int32_t layers, float weight,
           float* sum) {
  // `from` is seen from the trace that takes: when its link leads to the neighbour, the depths come back along it.
  const float sign = from.is_next ? -1.0f : 1.0f;
  for (std::int32_t l = 0; l < layers; ++l) {
    const float guess = field.dip(from.link, from.axis, depth[l]);
    const float dip = field.dip(from.link, from.axis, depth[l] + sign * 0.5f * guess);
    sum[l] += weight * (depth[l] + sign * dip);
  }
}

}  // namespace

PaintOrder order_traces(const DipField& field, int threads) {
  PaintOrder order;
  fill_costs(field, threads, order);
  const std::size_t count = field.trace_count();
  std::vector<float> distance(count, std::numeric_limits<float>::infinity());
  std::vector<std::uint8_t> is_done(count);
  using Entry = std::pair<float, std::size_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  const std::size_t reference = reference_trace(field, order);
  distance[reference] = 0;
  queue.emplace(0.0f, reference);
  order.trace.reserve(count);
  while (!queue.empty()) {
    const std::size_t trace = queue.top().second;
    queue.pop();
    if (is_done[trace] != 0) continue;
    is_done[trace] = 1;
    order.trace.push_back(static_cast<std::int32_t>(trace));
    each_neighbour(field.shape(), trace, [&](const Neighbour& n) {
      const float through = distance[trace] + cost_of(order, n);
      if (through >= distance[n.trace]) return;
      distance[n.trace] = through;
      queue.emplace(through, n.trace);
    });
  }
  return order;
}

Result<void> paint_layers(const DipField& field, const PaintOrder& order, const Progress& progress,
                          LayerDepths& depths) {
  const std::int32_t layers = depths.layers;
  depths.reference = static_cast<std::size_t>(order.trace.front());
  depths.depth.assign(depths.trace_count() * static_cast<std::size_t>(layers), 0.0f);
  float* first = depths.trace(depths.reference);
  for (std::int32_t l = 0; l < layers; ++l) first[l] = static_cast<float>(depths.first + l * depths.spacing);
  std::vector<std::uint8_t> is_done(depths.trace_count());
  is_done[depths.reference] = 1;
  for (std::size_t n = 1; n < order.trace.size(); ++n) {
    if (n % kTracesBetweenLooks == 0 && progress.cancelled()) {
      return Error{ErrorCode::cancelled, "laying the structural grid was cancelled"};
    }
    const auto trace = static_cast<std::size_t>(order.trace[n]);
    float* here = depths.trace(trace);
    float weights = 0;
    each_neighbour(field.shape(), trace, [&](const Neighbour& from) {
      if (is_done[from.trace] == 0) return;
      const float cost = cost_of(order, from), weight = 1 / (cost * cost);
      carry(field, from, depths.trace(from.trace), layers, weight, here);
      weights += weight;
    });
    const float share = 1 / weights;
    for (std::int32_t l = 0; l < layers; ++l) here[l] *= share;
    make_rising(here, layers, depths.spacing);
    is_done[trace] = 1;
  }
  return {};
}

}  // namespace geosis
