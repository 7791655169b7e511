#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/base/parallel.h"
#include "engine/structure/inline_planes.h"
#include "engine/structure/plane_ring.h"
#include "engine/structure/scan_dips.h"
#include "engine/structure/smoothing.h"
#include "engine/structure/warped_trace.h"

namespace geosis {
namespace {

constexpr double kLateralSigma = 2, kDepthSigma = 4;
constexpr std::int32_t kBatch = 16;
constexpr std::size_t kTerms = 3;  // of each axis: here squared, next squared, here times next

class Scan {
 public:
  Scan(const BrickedVolume& measured, const VerticalScan& vertical, int threads, DipField& field)
      : measured_(measured),
        vertical_(vertical),
        threads_(threads),
        field_(field),
        shape_(measured.shape()),
        rows_(static_cast<std::size_t>(shape_.crosslines)),
        samples_(static_cast<std::size_t>(shape_.samples)),
        stored_(static_cast<std::size_t>(field.agreements())),
        lateral_kernel_(smoothing_kernel(kLateralSigma)),
        depth_kernel_(smoothing_kernel(kDepthSigma)),
        wide_(static_cast<std::int32_t>(lateral_kernel_.size()) - 1),
        value_(rows_ * samples_, kBatch + 2 * wide_ + 8),
        products_(2 * kTerms * rows_ * stored_, kBatch + 2 * wide_ + 8) {}

  Result<void> run(const Progress& progress, const std::function<void(double)>& report) {
    for (std::int32_t first = 0; first < shape_.inlines; first += kBatch) {
      if (progress.cancelled()) return Error{ErrorCode::cancelled, "the search for dips was cancelled"};
      report(static_cast<double>(first) / shape_.inlines);
      const std::int32_t end = std::min(first + kBatch, shape_.inlines);
      if (auto loaded = load_until(std::min(end + wide_ + 1, shape_.inlines)); !loaded) return loaded;
      multiply_until(std::min(end + wide_, shape_.inlines));
      correlate(first, end);
    }
    return {};
  }

 private:
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
  std::size_t term_at(LinkAxis axis, std::size_t term, std::size_t j) const {
    return ((static_cast<std::size_t>(axis) * kTerms + term) * rows_ + j) * stored_;
  }

  void multiply_until(std::int32_t end) {
    if (end <= multiplied_) return;
    parallel_for(static_cast<std::size_t>(end - multiplied_), threads_, [&](std::size_t n) {
      const std::int32_t i = multiplied_ + static_cast<std::int32_t>(n);
      float* plane = products_.plane(i);
      thread_local std::vector<float> scratch;
      for (const LinkAxis axis : kLinkAxes) {
        for (std::int32_t j = 0; j < shape_.crosslines; ++j) multiply_link(i, j, axis, plane);
        for (std::size_t term = 0; term < kTerms; ++term) {
          smooth_across_rows(plane + term_at(axis, term, 0), rows_, stored_, stored_, lateral_kernel_, scratch);
        }
      }
    });
    multiplied_ = end;
  }

  /// The link's two traces, warped to the middle between them, times each other.
  void multiply_link(std::int32_t i, std::int32_t j, LinkAxis axis, float* plane) const {
    const auto row = static_cast<std::size_t>(j);
    if (!field_.has_link(i, j, axis)) {
      for (std::size_t term = 0; term < kTerms; ++term) std::fill_n(plane + term_at(axis, term, row), stored_, 0.0f);
      return;
    }
    thread_local WarpedTrace here, next;
    thread_local std::vector<float> terms, scratch;
    terms.resize(kTerms * samples_);
    here.load(trace(i, j), samples_);
    next.load(axis == LinkAxis::inline_ ? trace(i + 1, j) : trace(i, j + 1), samples_);
    const std::size_t link = field_.trace_of(i, j);
    for (std::size_t k = 0; k < samples_; ++k) {
      const float half = 0.5f * field_.dip(link, axis, static_cast<float>(k));
      const float a = here.at(k, -half), b = next.at(k, half);
      const bool is_known = !std::isnan(a) && !std::isnan(b);
      terms[k] = is_known ? a * a : 0;
      terms[samples_ + k] = is_known ? b * b : 0;
      terms[2 * samples_ + k] = is_known ? a * b : 0;
    }
    for (std::size_t term = 0; term < kTerms; ++term) {
      float* from = terms.data() + term * samples_;
      smooth_along_row(from, samples_, depth_kernel_, scratch);
      float* to = plane + term_at(axis, term, row);
      for (std::size_t m = 0; m < stored_; ++m) to[m] = from[m * DipField::kAgreementSpacing];
    }
  }

  void correlate(std::int32_t first, std::int32_t end) {
    parallel_for(rows_, threads_, [&](std::size_t j) {
      for (std::int32_t i = first; i < end; ++i) {
        for (const LinkAxis axis : kLinkAxes) correlate_link(i, static_cast<std::int32_t>(j), axis);
      }
    });
  }

  void correlate_link(std::int32_t i, std::int32_t j, LinkAxis axis) {
    if (!field_.has_link(i, j, axis)) return;
    thread_local std::array<std::vector<float>, kTerms> sum;
    for (std::size_t term = 0; term < kTerms; ++term) {
      sum[term].resize(stored_);
      smooth_row_among(sum[term].data(), i, shape_.inlines, stored_, lateral_kernel_, [&](std::int32_t n) {
        return products_.plane(n) + term_at(axis, term, static_cast<std::size_t>(j));
      });
    }
    const float* here = trace(i, j);
    const float* next = axis == LinkAxis::inline_ ? trace(i + 1, j) : trace(i, j + 1);
    std::uint8_t* to = field_.agreements(field_.trace_of(i, j), axis);
    for (std::size_t m = 0; m < stored_; ++m) {
      const std::size_t k = m * DipField::kAgreementSpacing;
      const float size = std::sqrt(sum[0][m] * sum[1][m]);
      const bool is_known = size > 0 && !std::isnan(here[k]) && !std::isnan(next[k]);
      const float agreement = is_known ? std::clamp(sum[2][m] / size, 0.0f, 1.0f) : 0;
      to[m] = static_cast<std::uint8_t>(std::lround(agreement * 255));
    }
  }

  const BrickedVolume& measured_;
  const VerticalScan& vertical_;
  const int threads_;
  DipField& field_;
  const GridShape shape_;
  const std::size_t rows_, samples_, stored_;
  const std::vector<float> lateral_kernel_, depth_kernel_;
  const std::int32_t wide_;
  PlaneRing<float> value_, products_;
  std::int32_t loaded_ = 0, multiplied_ = 0;
};

}  // namespace

Result<void> scan_agreements(const BrickedVolume& measured, const VerticalScan& scan, int threads,
                             const Progress& progress, const std::function<void(double)>& report, DipField& field) {
  return Scan(measured, scan, threads, field).run(progress, report);
}

}  // namespace geosis
