#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "engine/base/parallel.h"
#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/structure/dip_field.h"
#include "engine/structure/inline_planes.h"
#include "engine/structure/plane_ring.h"
#include "engine/structure/scan_dips.h"
#include "engine/structure/smoothing.h"
#include "engine/structure/warped_trace.h"

namespace geosis {

/// Goes over all links, plane after plane: Rule makes terms of each link's two traces, warped along the dip to the
/// middle between them, and is given their means in a Gaussian window of sigma (2, 2, 4).
///
///     static constexpr std::size_t kTerms;
///     static constexpr std::int32_t kSpacing;    means are wanted at every so-manyth sample
///     static std::array<float, kTerms> terms(WarpedTrace::Point here, WarpedTrace::Point next);
///     void store(std::size_t trace, LinkAxis axis, const std::array<std::vector<float>, kTerms>& means,
///                const float* here, const float* next);      means; the link's traces as they are, NaN = missing
///
/// store() is called once a link, from several threads; it may change the link's own dips, which nobody looks at again.
template <class Rule>
class LinkScan {
 public:
  LinkScan(const BrickedVolume& measured, const VerticalScan& vertical, int threads, const DipField& field, Rule& rule)
      : measured_(measured),
        vertical_(vertical),
        threads_(threads),
        field_(field),
        rule_(rule),
        shape_(measured.shape()),
        rows_(static_cast<std::size_t>(shape_.crosslines)),
        samples_(static_cast<std::size_t>(shape_.samples)),
        stored_((samples_ - 1) / static_cast<std::size_t>(Rule::kSpacing) + 1),
        lateral_kernel_(smoothing_kernel(kLateralSigma)),
        depth_kernel_(smoothing_kernel(kDepthSigma)),
        wide_(static_cast<std::int32_t>(lateral_kernel_.size()) - 1),
        value_(rows_ * samples_, kBatch + 2 * wide_ + 8),
        terms_(2 * Rule::kTerms * rows_ * stored_, kBatch + 2 * wide_ + 8) {}

  Result<void> run(const Progress& progress, const std::function<void(double)>& report) {
    for (std::int32_t first = 0; first < shape_.inlines; first += kBatch) {
      if (progress.cancelled()) return Error{ErrorCode::cancelled, "the search for dips was cancelled"};
      report(static_cast<double>(first) / shape_.inlines);
      const std::int32_t end = std::min(first + kBatch, shape_.inlines);
      if (auto loaded = load_until(std::min(end + wide_ + 1, shape_.inlines)); !loaded) return loaded;
      multiply_until(std::min(end + wide_, shape_.inlines));
      parallel_for(rows_, threads_, [&](std::size_t j) {
        for (std::int32_t i = first; i < end; ++i) {
          for (const LinkAxis axis : kLinkAxes) average_link(i, static_cast<std::int32_t>(j), axis);
        }
      });
    }
    return {};
  }

 private:
  static constexpr double kLateralSigma = 2, kDepthSigma = 4;
  static constexpr std::int32_t kBatch = 16;

  Result<void> load_until(std::int32_t end) {
    if (end <= loaded_) return {};
    const auto box = read_planes(measured_, loaded_, end);
    if (!box) return box.error();
    const double scale = vertical_.deviation > 0 ? 1 / vertical_.deviation : 1;
    parallel_for(static_cast<std::size_t>(end - loaded_), threads_, [&](std::size_t n) {
      const float* raw = box->value.data() + n * rows_ * samples_;
      float* value = value_.plane(loaded_ + static_cast<std::int32_t>(n));
      for (std::size_t m = 0; m < rows_ * samples_; ++m) {
        value[m] = static_cast<float>((raw[m] - vertical_.mean) * scale);
      }
    });
    loaded_ = end;
    return {};
  }

  const float* trace(std::int32_t i, std::int32_t j) const {
    return value_.plane(i) + static_cast<std::size_t>(j) * samples_;
  }
  const float* next_trace(std::int32_t i, std::int32_t j, LinkAxis axis) const {
    return axis == LinkAxis::inline_ ? trace(i + 1, j) : trace(i, j + 1);
  }
  std::size_t term_at(LinkAxis axis, std::size_t term, std::size_t j) const {
    return ((static_cast<std::size_t>(axis) * Rule::kTerms + term) * rows_ + j) * stored_;
  }

  void multiply_until(std::int32_t end) {
    if (end <= multiplied_) return;
    parallel_for(static_cast<std::size_t>(end - multiplied_), threads_, [&](std::size_t n) {
      const std::int32_t i = multiplied_ + static_cast<std::int32_t>(n);
      float* plane = terms_.plane(i);
      thread_local std::vector<float> scratch;
      for (const LinkAxis axis : kLinkAxes) {
        for (std::int32_t j = 0; j < shape_.crosslines; ++j) multiply_link(i, j, axis, plane);
        for (std::size_t term = 0; term < Rule::kTerms; ++term) {
          smooth_across_rows(plane + term_at(axis, term, 0), rows_, stored_, stored_, lateral_kernel_, scratch);
        }
      }
    });
    multiplied_ = end;
  }

  /// One link's terms, smoothed along it; 0 where a trace is missing.
  void multiply_link(std::int32_t i, std::int32_t j, LinkAxis axis, float* plane) const {
    const auto row = static_cast<std::size_t>(j);
    if (!field_.has_link(i, j, axis)) {
      for (std::size_t t = 0; t < Rule::kTerms; ++t) std::fill_n(plane + term_at(axis, t, row), stored_, 0.0f);
      return;
    }
    thread_local WarpedTrace here, next;
    thread_local std::vector<float> terms, scratch;
    terms.resize(Rule::kTerms * samples_);
    here.load(trace(i, j), samples_);
    next.load(next_trace(i, j, axis), samples_);
    const std::size_t link = field_.trace_of(i, j);
    for (std::size_t k = 0; k < samples_; ++k) {
      const float half = 0.5f * field_.dip(link, axis, static_cast<float>(k));
      const auto a = here.point(k, -half), b = next.point(k, half);
      const bool is_known = !std::isnan(a.value + a.slope) && !std::isnan(b.value + b.slope);
      const auto term = is_known ? Rule::terms(a, b) : std::array<float, Rule::kTerms>{};
      for (std::size_t t = 0; t < Rule::kTerms; ++t) terms[t * samples_ + k] = term[t];
    }
    for (std::size_t t = 0; t < Rule::kTerms; ++t) {
      float* from = terms.data() + t * samples_;
      smooth_along_row(from, samples_, depth_kernel_, scratch);
      float* to = plane + term_at(axis, t, row);
      for (std::size_t m = 0; m < stored_; ++m) to[m] = from[m * static_cast<std::size_t>(Rule::kSpacing)];
    }
  }

  void average_link(std::int32_t i, std::int32_t j, LinkAxis axis) {
    if (!field_.has_link(i, j, axis)) return;
    thread_local std::array<std::vector<float>, Rule::kTerms> means;
    for (std::size_t term = 0; term < Rule::kTerms; ++term) {
      means[term].resize(stored_);
      smooth_row_among(means[term].data(), i, shape_.inlines, stored_, lateral_kernel_, [&](std::int32_t n) {
        return terms_.plane(n) + term_at(axis, term, static_cast<std::size_t>(j));
      });
    }
    rule_.store(field_.trace_of(i, j), axis, means, trace(i, j), next_trace(i, j, axis));
  }

  const BrickedVolume& measured_;
  const VerticalScan& vertical_;
  const int threads_;
  const DipField& field_;
  Rule& rule_;
  const GridShape shape_;
  const std::size_t rows_, samples_, stored_;
  const std::vector<float> lateral_kernel_, depth_kernel_;
  const std::int32_t wide_;
  PlaneRing<float> value_, terms_;
  std::int32_t loaded_ = 0, multiplied_ = 0;
};

}  // namespace geosis
