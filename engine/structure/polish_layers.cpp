#include "engine/structure/polish_layers.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "engine/base/parallel.h"

namespace geosis {
namespace {

constexpr int kRounds = 4, kSteps = 30;
constexpr float kLeastWeight = 1e-3f;     // of a link that does not agree at all
constexpr float kOutside = 0.02f;         // times that of places outside the box
constexpr float kTolerance = 0.3f;        // samples: beyond it a link loses weight
constexpr float kEvenThickness = 0.005f;  // against the links' 1
constexpr double kEnough = 1e-12;         // of the first residual squared: converged

/// Conjugate gradients for what the depths should change by, over all nodes but those of the reference trace.
class Polisher {
 public:
  Polisher(const DipField& field, LayerDepths& depths, int threads)
      : field_(field),
        depths_(depths),
        threads_(threads),
        shape_(depths.shape),
        layers_(static_cast<std::size_t>(depths.layers)),
        line_(layers_ * static_cast<std::size_t>(shape_.crosslines)),
        evenness_(kEvenThickness / static_cast<float>(depths.spacing) / static_cast<float>(depths.spacing)),
        partial_(static_cast<std::size_t>(shape_.inlines)) {
    const std::size_t count = depths.depth.size();
    for (auto& weight : weight_) weight.resize(count);
    residual_.resize(count);
    direction_.resize(count);
    image_.resize(count);
  }

  Result<void> run(const Progress& progress, const std::function<void(double)>& report) {
    for (int round = 0; round < kRounds; ++round) {
      weigh_links();
      begin();
      for (int step = 0; step < kSteps; ++step) {
        if (progress.cancelled()) return Error{ErrorCode::cancelled, "laying the structural grid was cancelled"};
        report((round + static_cast<double>(step) / kSteps) / kRounds);
        if (!advance()) break;
      }
      for_each_trace([&](std::size_t trace) { make_rising(depths_.trace(trace), depths_.layers, depths_.spacing); });
    }
    return {};
  }

 private:
  template <class Task>
  void for_each_plane(const Task& task) {
    parallel_for(static_cast<std::size_t>(shape_.inlines), threads_, task);
  }
  template <class Task>
  void for_each_trace(const Task& task) {
    const auto crosslines = static_cast<std::size_t>(shape_.crosslines);
    for_each_plane([&](std::size_t i) {
      for (std::size_t t = i * crosslines; t < (i + 1) * crosslines; ++t) task(t);
    });
  }
  /// The sum of what task(plane) says, in the planes' order.
  template <class Task>
  double sum_over_planes(const Task& task) {
    for_each_plane([&](std::size_t i) { partial_[i] = task(i); });
    double sum = 0;
    for (const double part : partial_) sum += part;
    return sum;
  }

  std::size_t stride(LinkAxis axis) const { return axis == LinkAxis::inline_ ? line_ : layers_; }

  /// Weights of all links, and in image_ and direction_ what each link of the two axes pulls its ends together by.
  void weigh_links() {
    for_each_trace([&](std::size_t trace) {
      const auto i = static_cast<std::int32_t>(trace / static_cast<std::size_t>(shape_.crosslines));
      const auto j = static_cast<std::int32_t>(trace % static_cast<std::size_t>(shape_.crosslines));
      for (const LinkAxis axis : kLinkAxes) {
        const std::size_t first = trace * layers_;
        float* weight = &weight_[static_cast<std::size_t>(axis)][first];
        float* pull = axis == LinkAxis::inline_ ? &image_[first] : &direction_[first];
        if (field_.has_link(i, j, axis)) {
          weigh_link(trace, axis, weight, pull);
        } else {
          std::fill_n(weight, layers_, 0.0f);
          std::fill_n(pull, layers_, 0.0f);
        }
      }
    });
  }

  void weigh_link(std::size_t trace, LinkAxis axis, float* weight, float* pull) const {
    const float* here = depths_.trace(trace);
    const float* next = here + stride(axis);
    const auto bottom = static_cast<float>(shape_.samples - 1);
    for (std::size_t l = 0; l < layers_; ++l) {
      const float middle = 0.5f * (here[l] + next[l]);
      const float off = next[l] - here[l] - field_.dip(trace, axis, middle);
      const float agreement = field_.agreement(trace, axis, middle);
      const float squared = agreement * agreement, fourth = squared * squared;
      const bool is_outside = middle < 0 || middle > bottom;
      const float sure = (fourth * fourth + kLeastWeight) * (is_outside ? kOutside : 1.0f);
      weight[l] = sure / (1 + off * off * (1 / (kTolerance * kTolerance)));
      pull[l] = weight[l] * off;
    }
  }

  /// First residual: what the links pull each node by, and the unevenness of its neighbours in the trace.
  void begin() {
    const auto crosslines = static_cast<std::size_t>(shape_.crosslines);
    for_each_trace([&](std::size_t trace) {
      const std::size_t first = trace * layers_;
      float* r = &residual_[first];
      if (trace == depths_.reference) return static_cast<void>(std::fill_n(r, layers_, 0.0f));
      for (std::size_t l = 0; l < layers_; ++l) r[l] = image_[first + l] + direction_[first + l];
      if (trace >= crosslines) subtract(r, &image_[first - line_]);
      if (trace % crosslines > 0) subtract(r, &direction_[first - layers_]);
      const float* z = depths_.trace(trace);
      const auto even = static_cast<float>(depths_.spacing);
      for (std::size_t l = 0; l + 1 < layers_; ++l) {
        const float uneven = evenness_ * (z[l + 1] - z[l] - even);
        r[l] += uneven;
        r[l + 1] -= uneven;
      }
    });
    energy_ = sum_over_planes([&](std::size_t i) { return start_directions(i); });
    enough_ = kEnough * energy_;
  }

  void subtract(float* r, const float* pull) const {
    for (std::size_t l = 0; l < layers_; ++l) r[l] -= pull[l];
  }

  /// direction = residual / diagonal; the sum of their products.
  double start_directions(std::size_t i) {
    double sum = 0;
    each_row(i, [&](std::size_t trace) {
      const float* inverse = inverse_diagonal(trace);
      const std::size_t first = trace * layers_;
      double row = 0;
      for (std::size_t l = 0; l < layers_; ++l) {
        direction_[first + l] = residual_[first + l] * inverse[l];
        row += double{residual_[first + l]} * direction_[first + l];
      }
      sum += row;
    });
    return sum;
  }

  /// One step. False when there is nothing left to do.
  bool advance() {
    if (!(energy_ > enough_)) return false;
    const double curvature = sum_over_planes([&](std::size_t i) { return apply(i); });
    if (!(curvature > 0)) return false;
    const auto length = static_cast<float>(energy_ / curvature);
    const double energy = sum_over_planes([&](std::size_t i) { return move(i, length); });
    const auto turn = static_cast<float>(energy / energy_);
    for_each_trace([&](std::size_t trace) {
      const float* inverse = inverse_diagonal(trace);
      const std::size_t first = trace * layers_;
      for (std::size_t l = 0; l < layers_; ++l) {
        direction_[first + l] = residual_[first + l] * inverse[l] + turn * direction_[first + l];
      }
    });
    energy_ = energy;
    return true;
  }

  /// image = matrix * direction in one plane; returns their product.
  double apply(std::size_t plane) {
    const auto crosslines = static_cast<std::size_t>(shape_.crosslines);
    double sum = 0;
    each_row(plane, [&](std::size_t trace) {
      const std::size_t first = trace * layers_;
      float* out = &image_[first];
      if (trace == depths_.reference) return static_cast<void>(std::fill_n(out, layers_, 0.0f));
      const float* d = &direction_[first];
      stiffen(d, out);
      const bool has_next_plane = plane + 1 < static_cast<std::size_t>(shape_.inlines);
      if (has_next_plane) link(d, d + line_, &weight_[0][first], out);
      if (plane > 0) link(d, d - line_, &weight_[0][first - line_], out);
      if (trace % crosslines + 1 < crosslines) link(d, d + layers_, &weight_[1][first], out);
      if (trace % crosslines > 0) link(d, d - layers_, &weight_[1][first - layers_], out);
      double row = 0;
      for (std::size_t l = 0; l < layers_; ++l) row += double{d[l]} * out[l];
      sum += row;
    });
    return sum;
  }

  void link(const float* d, const float* other, const float* weight, float* out) const {
    for (std::size_t l = 0; l < layers_; ++l) out[l] += weight[l] * (d[l] - other[l]);
  }

  void stiffen(const float* d, float* out) const {
    if (layers_ < 2) return static_cast<void>(std::fill_n(out, layers_, 0.0f));
    out[0] = evenness_ * (d[0] - d[1]);
    for (std::size_t l = 1; l + 1 < layers_; ++l) out[l] = evenness_ * (2 * d[l] - d[l - 1] - d[l + 1]);
    out[layers_ - 1] = evenness_ * (d[layers_ - 1] - d[layers_ - 2]);
  }

  /// Depths and residual go along the direction; returns the residual's energy.
  double move(std::size_t plane, float length) {
    double sum = 0;
    each_row(plane, [&](std::size_t trace) {
      const float* inverse = inverse_diagonal(trace);
      const std::size_t first = trace * layers_;
      float* z = depths_.trace(trace);
      double row = 0;
      for (std::size_t l = 0; l < layers_; ++l) {
        z[l] += length * direction_[first + l];
        float& r = residual_[first + l];
        r -= length * image_[first + l];
        row += double{r} * (r * inverse[l]);
      }
      sum += row;
    });
    return sum;
  }

  /// One over the matrix's diagonal along a trace, in scratch memory of the calling thread.
  const float* inverse_diagonal(std::size_t trace) const {
    thread_local std::vector<float> inverse;
    const auto crosslines = static_cast<std::size_t>(shape_.crosslines);
    const std::size_t first = trace * layers_;
    inverse.resize(layers_);
    for (std::size_t l = 0; l < layers_; ++l) {
      inverse[l] = 2 * evenness_ + weight_[0][first + l] + weight_[1][first + l];
    }
    const auto add = [&](const float* weight) {
      for (std::size_t l = 0; l < layers_; ++l) inverse[l] += weight[l];
    };
    if (trace >= crosslines) add(&weight_[0][first - line_]);
    if (trace % crosslines > 0) add(&weight_[1][first - layers_]);
    for (std::size_t l = 0; l < layers_; ++l) inverse[l] = 1 / inverse[l];
    return inverse.data();
  }

  template <class Task>
  void each_row(std::size_t plane, const Task& task) const {
    const auto crosslines = static_cast<std::size_t>(shape_.crosslines);
    for (std::size_t t = plane * crosslines; t < (plane + 1) * crosslines; ++t) task(t);
  }

  const DipField& field_;
  LayerDepths& depths_;
  const int threads_;
  const GridShape shape_;
  const std::size_t layers_, line_;
  const float evenness_;
  std::array<std::vector<float>, 2> weight_;
  std::vector<float> residual_, direction_, image_;
  std::vector<double> partial_;
  double energy_ = 0, enough_ = 0;
};

}  // namespace

Result<void> polish_layers(const DipField& field, LayerDepths& depths, int threads, const Progress& progress,
                           const std::function<void(double)>& report) {
  return Polisher(field, depths, threads).run(progress, report);
}

}  // namespace geosis
