#include "engine/structure/scan_dips.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/base/parallel.h"
#include "engine/structure/gradient_filter.h"
#include "engine/structure/inline_planes.h"
#include "engine/structure/plane_ring.h"
#include "engine/structure/smoothing.h"
#include "engine/structure/tensor_rows.h"

namespace geosis {
namespace {

constexpr double kTensorSigma = 2, kTensorDepthSigma = 3;
constexpr float kGapWeight = 0.003f;     // of gradients next to missing samples and to the survey's sides
constexpr std::int32_t kGapReach = 3;    // traces: beyond it the gradient's filter weighs next to nothing
constexpr std::int32_t kBatch = 16;      // planes worked on together
constexpr double kLeastContrast = 1e-5;  // of the samples' deviation, as a slope: below it there is no plane to see

/// The stages of the scan, each a few planes ahead of the next.
class Scan {
 public:
  Scan(const DipSamples& input, const VerticalScan& vertical, int threads, DipField& field)
      : input_(input),
        vertical_(vertical),
        threads_(threads),
        field_(field),
        shape_(input.samples.shape()),
        rows_(static_cast<std::size_t>(shape_.crosslines)),
        samples_(static_cast<std::size_t>(shape_.samples)),
        dips_(static_cast<std::size_t>(field.dips())),
        lateral_kernel_(smoothing_kernel(kTensorSigma)),
        depth_kernel_(smoothing_kernel(kTensorDepthSigma)),
        wide_(static_cast<std::int32_t>(lateral_kernel_.size()) - 1),
        valid_(rows_ * samples_, kBatch + wide_ + kGradientReach + kGapReach + 8),
        filtered_(3 * rows_ * samples_, kBatch + wide_ + 2 * kGradientReach + 8),
        products_(rows_ * dips_ * kTensorTerms, kBatch + 2 * wide_ + 8) {}

  Result<void> run(const Progress& progress, const std::function<void(double)>& report) {
    for (std::int32_t first = 0; first < shape_.inlines; first += kBatch) {
      if (progress.cancelled()) return Error{ErrorCode::cancelled, "the search for dips was cancelled"};
      report(static_cast<double>(first) / shape_.inlines);
      const std::int32_t end = std::min(first + kBatch, shape_.inlines);
      if (auto loaded = load_until(clip(end + wide_ + kGradientReach)); !loaded) return loaded;
      multiply_until(clip(end + wide_));
      find_dips(first, end);
    }
    return {};
  }

 private:
  std::int32_t clip(std::int32_t end) const { return std::min(end, shape_.inlines); }

  /// Samples, scaled, filtered within their plane in three ways: for the slopes along the three axes.
  Result<void> load_until(std::int32_t end) {
    if (end <= loaded_) return {};
    auto box = read_planes(input_.samples, loaded_, end);
    if (!box) return std::move(box).error();
    auto measured =
        input_.measured == nullptr ? Result<SampleBox>(SampleBox{}) : read_planes(*input_.measured, loaded_, end);
    if (!measured) return std::move(measured).error();
    const std::vector<float>& mask = input_.measured == nullptr ? box->value : measured->value;
    const std::size_t count = rows_ * samples_;
    parallel_for(static_cast<std::size_t>(end - loaded_), threads_, [&](std::size_t n) {
      const std::int32_t i = loaded_ + static_cast<std::int32_t>(n);
      std::uint8_t* valid = valid_.plane(i);
      for (std::size_t m = 0; m < count; ++m) valid[m] = std::isnan(mask[n * count + m]) ? 0 : 1;
    });
    parallel_for(static_cast<std::size_t>(end - loaded_), threads_, [&](std::size_t n) {
      float* value = box->value.data() + n * count;
      const double scale = vertical_.deviation > 0 ? 1 / vertical_.deviation : 1;
      for (std::size_t m = 0; m < count; ++m) {
        value[m] = std::isnan(value[m]) ? 0 : static_cast<float>((value[m] - vertical_.mean) * scale);
      }
      filter_plane(value, filtered_.plane(loaded_ + static_cast<std::int32_t>(n)));
    });
    loaded_ = end;
    return {};
  }

  /// out (3, rows, samples): smooth along both; slope from row to row; slope along the rows.
  void filter_plane(const float* value, float* out) const {
    thread_local std::vector<float> smooth, slope;
    const std::size_t count = rows_ * samples_;
    smooth.resize(count);
    slope.resize(count);
    for (std::size_t j = 0; j < rows_; ++j) {
      filter_along_row(value + j * samples_, samples_, smooth.data() + j * samples_, slope.data() + j * samples_);
    }
    for (std::int32_t j = 0; j < shape_.crosslines; ++j) {
      const auto row_of = [&](const std::vector<float>& plane) {
        return [&plane, this](std::int32_t b) { return plane.data() + static_cast<std::size_t>(b) * samples_; };
      };
      float* to = out + static_cast<std::size_t>(j) * samples_;
      smooth_among(to, j, shape_.crosslines, samples_, row_of(smooth));
      slope_among(to + count, j, shape_.crosslines, samples_, row_of(smooth));
      smooth_among(to + 2 * count, j, shape_.crosslines, samples_, row_of(slope));
    }
  }

  /// Products of the gradient's components, smoothed within their plane.
  void multiply_until(std::int32_t end) {
    if (end <= multiplied_) return;
    parallel_for(static_cast<std::size_t>(end - multiplied_), threads_, [&](std::size_t n) {
      const std::int32_t i = multiplied_ + static_cast<std::int32_t>(n);
      thread_local std::vector<float> scratch;
      float* plane = products_.plane(i);
      for (std::size_t j = 0; j < rows_; ++j) multiply_row(i, static_cast<std::int32_t>(j), plane + j * dips_);
      for (std::size_t term = 0; term < kTensorTerms; ++term) {
        smooth_across_rows(plane + term * rows_ * dips_, rows_, dips_, dips_, lateral_kernel_, scratch);
      }
    });
    multiplied_ = end;
  }

  /// One row's products, smoothed along it; term t at out + t * rows * dips.
  void multiply_row(std::int32_t i, std::int32_t j, float* out) {
    thread_local std::vector<float> weight, gradient, terms, scratch;
    weight.resize(samples_);
    terms.resize(samples_ * kTensorTerms);
    gradient.resize(samples_ * 3);
    fill_weights(i, j, weight.data());
    const auto filtered = [&](std::size_t way) {
      return [this, way, j](std::int32_t n) {
        return filtered_.plane(n) + (way * rows_ + static_cast<std::size_t>(j)) * samples_;
      };
    };
    slope_among(gradient.data(), i, shape_.inlines, samples_, filtered(0));
    smooth_among(gradient.data() + samples_, i, shape_.inlines, samples_, filtered(1));
    smooth_among(gradient.data() + 2 * samples_, i, shape_.inlines, samples_, filtered(2));
    gradient_products(gradient.data(), weight.data(), samples_, terms.data());
    for (std::size_t term = 0; term < kTensorTerms; ++term) {
      float* from = terms.data() + term * samples_;
      smooth_along_row(from, samples_, depth_kernel_, scratch);
      float* to = out + term * rows_ * dips_;
      for (std::size_t m = 0; m < dips_; ++m) to[m] = from[m * DipField::kDipSpacing];
    }
  }

  /// 0 at missing samples, next to nothing where the gradient leans on what is not there.
  void fill_weights(std::int32_t i, std::int32_t j, float* weight) {
    const std::uint8_t* here = valid_.plane(i) + static_cast<std::size_t>(j) * samples_;
    for (std::size_t k = 0; k < samples_; ++k) weight[k] = here[k] != 0 ? 1.0f : 0.0f;
    const auto weaken = [&](std::int32_t a, std::int32_t b) {
      const bool is_there = a >= 0 && b >= 0 && a < shape_.inlines && b < shape_.crosslines;
      const std::uint8_t* there = is_there ? valid_.plane(a) + static_cast<std::size_t>(b) * samples_ : nullptr;
      for (std::size_t k = 0; k < samples_; ++k) {
        if (there == nullptr || there[k] == 0) weight[k] = std::min(weight[k], kGapWeight);
      }
    };
    for (std::int32_t step = 1; step <= kGapReach; ++step) {
      weaken(i - step, j);
      weaken(i + step, j);
      weaken(i, j - step);
      weaken(i, j + step);
    }
  }

  /// Tensors smoothed across planes, their main direction, and the dips of links between them.
  void find_dips(std::int32_t first, std::int32_t end) {
    for_each_row(first, end, [&](std::int32_t i, std::size_t j) {
      thread_local std::vector<float> tensor, dip;
      tensor.resize(dips_ * kTensorTerms);
      dip.resize(dips_ * 2);
      for (std::size_t term = 0; term < kTensorTerms; ++term) {
        smooth_row_among(tensor.data() + term * dips_, i, shape_.inlines, dips_, lateral_kernel_,
                         [&](std::int32_t n) { return products_.plane(n) + (term * rows_ + j) * dips_; });
      }
      const auto least = static_cast<float>(kLeastContrast * kLeastContrast) * kGapWeight;
      main_dips(tensor.data(), dips_, least, dip.data());
      const std::size_t trace = field_.trace_of(i, static_cast<std::int32_t>(j));
      for (const LinkAxis axis : kLinkAxes) {
        const float* found = dip.data() + static_cast<std::size_t>(axis) * dips_;
        std::int16_t* to = field_.dips(trace, axis);
        for (std::size_t m = 0; m < dips_; ++m) {
          to[m] = std::isnan(found[m]) ? DipField::kUnknown : DipField::stored(found[m]);
        }
      }
    });
  }

  template <class Task>
  void for_each_row(std::int32_t begin, std::int32_t end, const Task& task) const {
    parallel_for(rows_, threads_, [&](std::size_t j) {
      for (std::int32_t i = begin; i < end; ++i) task(i, j);
    });
  }

  const DipSamples& input_;
  const VerticalScan& vertical_;
  const int threads_;
  DipField& field_;
  const GridShape shape_;
  const std::size_t rows_, samples_, dips_;
  const std::vector<float> lateral_kernel_, depth_kernel_;
  const std::int32_t wide_;
  PlaneRing<std::uint8_t> valid_;
  PlaneRing<float> filtered_, products_;
  std::int32_t loaded_ = 0, multiplied_ = 0;
};

/// Dips at nodes become dips of links: the mean of the two ends that know theirs.
void average_links(DipField& field, int threads) {
  const GridShape shape = field.shape();
  const auto dips = static_cast<std::size_t>(field.dips());
  const auto average = [&](std::int16_t* here, const std::int16_t* next) {
    for (std::size_t m = 0; m < dips; ++m) {
      if (next[m] == DipField::kUnknown) continue;
      here[m] = here[m] == DipField::kUnknown ? next[m] : static_cast<std::int16_t>((here[m] + next[m]) / 2);
    }
  };
  // Each trace takes from the next one, which must still be as found: along one line in order.
  parallel_for(static_cast<std::size_t>(shape.crosslines), threads, [&](std::size_t j) {
    const auto column = static_cast<std::int32_t>(j);
    for (std::int32_t i = 0; i + 1 < shape.inlines; ++i) {
      average(field.dips(field.trace_of(i, column), LinkAxis::inline_),
              field.dips(field.trace_of(i + 1, column), LinkAxis::inline_));
    }
  });
  parallel_for(static_cast<std::size_t>(shape.inlines), threads, [&](std::size_t i) {
    const auto row = static_cast<std::int32_t>(i);
    for (std::int32_t j = 0; j + 1 < shape.crosslines; ++j) {
      average(field.dips(field.trace_of(row, j), LinkAxis::crossline),
              field.dips(field.trace_of(row, j + 1), LinkAxis::crossline));
    }
  });
}

}  // namespace

Result<DipField> scan_dips(const DipSamples& input, const VerticalScan& scan, int threads, const Progress& progress,
                           const std::function<void(double)>& report) {
  DipField field(input.samples.shape());
  auto done = Scan(input, scan, threads, field).run(progress, report);
  if (!done) return std::move(done).error();
  average_links(field, threads);
  return field;
}

}  // namespace geosis
