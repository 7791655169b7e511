#include "engine/missing/plate/steered_paths.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace geosis {
namespace {

constexpr double kLongestToShortest = 20;  // of the steps

std::size_t trace_start(GridShape shape, std::int32_t i, std::int32_t j) {
  return (static_cast<std::size_t>(i) * shape.crosslines + j) * static_cast<std::size_t>(shape.samples);
}

bool has_trace(GridShape shape, std::int32_t i, std::int32_t j) {
  return i >= 0 && j >= 0 && i < shape.inlines && j < shape.crosslines;
}

/// A link's dips belong to the depth half way: from the ends, they are looked up there.
float depth_over(const float* link, std::int32_t samples, std::int32_t k, float direction) {
  const auto depth = static_cast<float>(k);
  const float dip = sample_at(link, samples, depth + 0.5f * direction * link[k]);
  return std::clamp(depth + direction * dip, 0.0f, static_cast<float>(samples - 1));
}

void follow_links(SteeredPaths& paths, Neighbour neighbour, const std::vector<float>& links) {
  const GridShape shape = paths.shape;
  const TraceStep step = kTraceSteps[neighbour];
  const float direction = static_cast<float>(step.inlines + step.crosslines);
  for (std::int32_t i = 0; i < shape.inlines; ++i) {
    for (std::int32_t j = 0; j < shape.crosslines; ++j) {
      if (!has_trace(shape, i + step.inlines, j + step.crosslines)) continue;
      const std::size_t here = trace_start(shape, i, j);
      const std::size_t owner = direction > 0 ? here : trace_start(shape, i + step.inlines, j + step.crosslines);
      for (std::int32_t k = 0; k < shape.samples; ++k) {
        paths.depth[neighbour][here + k] = depth_over(&links[owner], shape.samples, k, direction);
      }
    }
  }
}

void follow_corners(SteeredPaths& paths) {
  const GridShape shape = paths.shape;
  const auto& by_inline = paths.depth[next_inline];
  const auto& by_crossline = paths.depth[next_crossline];
  for (std::int32_t i = 0; i + 1 < shape.inlines; ++i) {
    for (std::int32_t j = 0; j + 1 < shape.crosslines; ++j) {
      const std::size_t here = trace_start(shape, i, j);
      const float* inline_first = &by_crossline[trace_start(shape, i + 1, j)];
      const float* crossline_first = &by_inline[trace_start(shape, i, j + 1)];
      for (std::int32_t k = 0; k < shape.samples; ++k) {
        const float one = sample_at(inline_first, shape.samples, by_inline[here + k]);
        const float other = sample_at(crossline_first, shape.samples, by_crossline[here + k]);
        paths.depth[corner][here + k] = 0.5f * (one + other);
      }
    }
  }
}

/// What a walk found: the value on the reflector, so many traces away.
struct Met {
  float value;
  float traces;
};

class Walker {
 public:
  Walker(std::span<const float> value, std::span<const NodeState> state, const SteeredPaths& paths)
      : value_(value), state_(state), paths_(paths) {}

  std::optional<Met> walk(std::int32_t i, std::int32_t j, std::int32_t k, Neighbour towards) const {
    const GridShape shape = paths_.shape;
    const TraceStep step = kTraceSteps[towards];
    const auto last = static_cast<float>(shape.samples - 1);
    auto depth = static_cast<float>(k);
    for (std::int32_t traces = 1;; ++traces) {
      if (!has_trace(shape, i + step.inlines, j + step.crosslines)) return std::nullopt;
      depth = sample_at(&paths_.depth[towards][trace_start(shape, i, j)], shape.samples, depth);
      i += step.inlines;
      j += step.crosslines;
      const bool has_left = (depth <= 0 && k > 0) || (depth >= last && k + 1 < shape.samples);
      if (has_left) return std::nullopt;
      const auto below = static_cast<std::size_t>(depth);
      const std::size_t first = trace_start(shape, i, j);
      const std::size_t above = std::min(below + 1, static_cast<std::size_t>(shape.samples - 1));
      if (state_[first + below] != NodeState::known || state_[first + above] != NodeState::known) continue;
      return Met{sample_at(&value_[first], shape.samples, depth), static_cast<float>(traces)};
    }
  }

 private:
  std::span<const float> value_;
  std::span<const NodeState> state_;
  const SteeredPaths& paths_;
};

/// Sums of the pairs' linear values, and of the lonely samples for nodes without a pair.
class Barycentre {
 public:
  void add(const std::optional<Met>& one, const std::optional<Met>& other, float step) {
    if (one && other) {
      const float near = 1 / (step * one->traces), far = 1 / (step * other->traces);
      const float weight = (near + far) * (near + far);
      pairs_ += weight * (near * one->value + far * other->value) / (near + far);
      pair_weight_ += weight;
    } else if (one || other) {
      const Met& met = one ? *one : *other;
      const float weight = 1 / (step * met.traces * (step * met.traces));
      lonely_ += weight * met.value;
      lonely_weight_ += weight;
    }
  }

  std::optional<float> value() const {
    if (pair_weight_ > 0) return pairs_ / pair_weight_;
    if (lonely_weight_ > 0) return lonely_ / lonely_weight_;
    return std::nullopt;
  }

 private:
  float pairs_ = 0, pair_weight_ = 0, lonely_ = 0, lonely_weight_ = 0;
};

/// How much the samples of neighbouring traces differ along the dips, beside how much they do on the same level: the
/// ratio of the root mean squares, at most 1.
double share_along_dips(std::span<const float> value, std::span<const NodeState> state, const SteeredPaths& paths,
                        Neighbour towards) {
  const GridShape shape = paths.shape;
  const TraceStep step = kTraceSteps[towards];
  double along = 0, level = 0;
  for (std::int32_t i = 0; i < shape.inlines; ++i) {
    for (std::int32_t j = 0; j < shape.crosslines; ++j) {
      if (!has_trace(shape, i + step.inlines, j + step.crosslines)) continue;
      const std::size_t here = trace_start(shape, i, j);
      const std::size_t there = trace_start(shape, i + step.inlines, j + step.crosslines);
      for (std::int32_t k = 0; k < shape.samples; ++k) {
        const float depth = paths.depth[towards][here + k];
        const auto above = static_cast<std::size_t>(depth);
        const std::size_t below = std::min(above + 1, static_cast<std::size_t>(shape.samples - 1));
        const bool is_known = state[here + k] == NodeState::known && state[there + k] == NodeState::known &&
                              state[there + above] == NodeState::known && state[there + below] == NodeState::known;
        if (!is_known) continue;
        const double steered = double{sample_at(&value[there], shape.samples, depth)} - value[here + k];
        const double straight = double{value[there + k]} - value[here + k];
        along += steered * steered;
        level += straight * straight;
      }
    }
  }
  return level > 0 ? std::min(1.0, std::sqrt(along / level)) : 1;
}

}  // namespace

float sample_at(const float* trace, std::int32_t count, float depth) {
  const auto last = static_cast<float>(count - 1);
  if (!(depth > 0)) return trace[0];
  if (depth >= last) return trace[count - 1];
  const auto below = static_cast<std::int32_t>(depth);
  const float t = depth - static_cast<float>(below);
  return trace[below] + t * (trace[below + 1] - trace[below]);
}

SteeredPaths follow_dips(const Dips& dips) {
  SteeredPaths paths{dips.shape, {}};
  const auto samples = static_cast<std::size_t>(dips.shape.samples);
  for (auto& depth : paths.depth) {
    depth.resize(static_cast<std::size_t>(dips.shape.count()));
    for (std::size_t n = 0; n < depth.size(); ++n) depth[n] = static_cast<float>(n % samples);
  }
  follow_links(paths, next_inline, dips.to_next_inline);
  follow_links(paths, previous_inline, dips.to_next_inline);
  follow_links(paths, next_crossline, dips.to_next_crossline);
  follow_links(paths, previous_crossline, dips.to_next_crossline);
  follow_corners(paths);
  return paths;
}

Vec3d steps_along_dips(std::span<const float> value, std::span<const NodeState> state, const SteeredPaths& paths,
                       const Vec3d& step_lengths) {
  Vec3d steps = step_lengths;
  const double inlines = share_along_dips(value, state, paths, next_inline);
  const double crosslines = share_along_dips(value, state, paths, next_crossline);
  const double least = std::max({steps.x, steps.y, steps.z}) / kLongestToShortest;
  steps.x = std::max(steps.x * inlines, std::min(steps.x, least));
  steps.y = std::max(steps.y * crosslines, std::min(steps.y, least));
  return steps;
}

void start_along_dips(std::span<float> value, std::span<const NodeState> state, const SteeredPaths& paths,
                      const Vec3d& step_lengths) {
  const GridShape shape = paths.shape;
  const Walker walker(value, state, paths);
  std::size_t n = 0;
  for (std::int32_t i = 0; i < shape.inlines; ++i) {
    for (std::int32_t j = 0; j < shape.crosslines; ++j) {
      for (std::int32_t k = 0; k < shape.samples; ++k, ++n) {
        if (state[n] != NodeState::wanted) continue;
        Barycentre mean;
        mean.add(walker.walk(i, j, k, next_inline), walker.walk(i, j, k, previous_inline),
                 static_cast<float>(step_lengths.x));
        mean.add(walker.walk(i, j, k, next_crossline), walker.walk(i, j, k, previous_crossline),
                 static_cast<float>(step_lengths.y));
        // Walks read known samples only, so wanted ones may be replaced on the way.
        if (const auto found = mean.value()) value[n] = *found;
      }
    }
  }
}

}  // namespace geosis
