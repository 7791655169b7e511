#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "engine/base/parallel.h"
#include "engine/structure/dips.h"
#include "engine/structure/sample_scale.h"
#include "engine/structure/smoothing.h"
#include "engine/structure/symmetric_eigen.h"

namespace geosis {
namespace {

constexpr Vec3d kGradientWindow = {1, 1, 1};
constexpr Vec3d kTensorWindow = {2, 2, 3};
constexpr std::int32_t kGradientReach = 2;  // traces
constexpr double kLeastContrast = 1e-10;    // of the box's largest squared gradient: below it there is no plane to see

/// The box's structure tensor at every node.
class StructureTensor {
 public:
  StructureTensor(const SampleBox& box, const DipOptions& options) : box_(box), options_(options) {}

  /// false when cancelled.
  bool compute(const Progress& progress) {
    const auto count = static_cast<std::size_t>(box_.shape.count());
    if (!smooth_samples(progress)) return false;
    for (auto& product : products_) product.resize(count);
    for_each_node([&](std::int32_t i, std::int32_t j, std::int32_t k) { fill_products(i, j, k); });
    smoothed_ = {};
    for (auto& product : products_) {
      if (progress.cancelled()) return false;
      smooth(product, box_.shape, kTensorWindow, options_.threads);
    }
    for (std::size_t n = 0; n < count; ++n) largest_ = std::max(largest_, trace_at(n));
    return true;
  }

  /// Of the tensor times a positive number, 0 where there is no contrast.
  SymmetricMatrix at(std::size_t n) const {
    const double trace = trace_at(n);
    if (!(trace > kLeastContrast * largest_ * options_.filled_weight)) return {};
    const auto scaled = [&](std::size_t product) { return products_[product][n] / trace; };
    return {scaled(0), scaled(1), scaled(2), scaled(3), scaled(4), scaled(5)};
  }

  template <class Task>
  void for_each_node(const Task& task) const {
    parallel_for(static_cast<std::size_t>(box_.shape.inlines), options_.threads, [&](std::size_t plane) {
      const auto i = static_cast<std::int32_t>(plane);
      for (std::int32_t j = 0; j < box_.shape.crosslines; ++j) {
        for (std::int32_t k = 0; k < box_.shape.samples; ++k) task(i, j, k);
      }
    });
  }

 private:
  double trace_at(std::size_t n) const { return double{products_[0][n]} + products_[1][n] + products_[2][n]; }

  /// The samples, smoothed as if missing ones were not there.
  bool smooth_samples(const Progress& progress) {
    const double scale = power_of_two_scale(box_.value);
    const double middle = middle_of_range();
    std::vector<float> weight(box_.value.size());
    smoothed_.resize(box_.value.size());
    for (std::size_t n = 0; n < weight.size(); ++n) {
      const bool is_valid = std::isfinite(box_.value[n]);
      weight[n] = is_valid ? 1 : 0;
      smoothed_[n] = is_valid ? static_cast<float>((box_.value[n] - middle) * scale) : 0;
    }
    if (progress.cancelled()) return false;
    smooth(smoothed_, box_.shape, kGradientWindow, options_.threads);
    smooth(weight, box_.shape, kGradientWindow, options_.threads);
    for (std::size_t n = 0; n < weight.size(); ++n) smoothed_[n] = weight[n] > 0 ? smoothed_[n] / weight[n] : 0;
    return true;
  }

  /// What a constant box must be told from zero by: exactly its value then.
  double middle_of_range() const {
    double low = 0, high = 0;
    bool is_first = true;
    for (const float sample : box_.value) {
      if (!std::isfinite(sample)) continue;
      low = is_first ? sample : std::min(low, double{sample});
      high = is_first ? sample : std::max(high, double{sample});
      is_first = false;
    }
    return 0.5 * (low + high);
  }

  /// Central difference; one-sided at the box's faces.
  float slope(std::int32_t i, std::int32_t j, std::int32_t k, int axis) const {
    GridIndex before{i, j, k}, after{i, j, k};
    before[axis] = std::max(before[axis] - 1, 0);
    after[axis] = std::min(after[axis] + 1, box_.shape[axis] - 1);
    if (after[axis] == before[axis]) return 0;
    return (smoothed_[box_.at(after.i, after.j, after.k)] - smoothed_[box_.at(before.i, before.j, before.k)]) /
           static_cast<float>(after[axis] - before[axis]);
  }

  float node_weight(std::int32_t i, std::int32_t j, std::int32_t k) const {
    if (i < 0 || j < 0 || i >= box_.shape.inlines || j >= box_.shape.crosslines) {
      return options_.filled_weight;
    }
    const std::size_t n = box_.at(i, j, k);
    if (!std::isfinite(box_.value[n])) return 0;
    return options_.measured.empty() || options_.measured[n] != 0 ? 1 : options_.filled_weight;
  }

  void fill_products(std::int32_t i, std::int32_t j, std::int32_t k) {
    // Next to gaps and to the box's sides the gradient leans on what is not there.
    float weight = node_weight(i, j, k);
    for (const std::int32_t step : {-kGradientReach, -1, 1, kGradientReach}) {
      weight = std::min({weight, node_weight(i + step, j, k), node_weight(i, j + step, k)});
    }
    const float x = slope(i, j, k, 0), y = slope(i, j, k, 1), z = slope(i, j, k, 2);
    const std::size_t n = box_.at(i, j, k);
    const std::array<float, 6> product = {x * x, y * y, z * z, x * y, x * z, y * z};
    for (std::size_t p = 0; p < product.size(); ++p) products_[p][n] = weight * product[p];
  }

  const SampleBox& box_;
  const DipOptions& options_;
  std::vector<float> smoothed_;
  std::array<std::vector<float>, 6> products_;
  double largest_ = 0;
};

float dip_of(double across, double down) {
  // The normal points along the gradient, so a reflector falls by -across / down.
  const double steep = kSteepestDip;
  if (std::abs(across) >= steep * std::abs(down)) return (across > 0) == (down > 0) ? -kSteepestDip : kSteepestDip;
  return static_cast<float>(-across / down);
}

/// Node dips become link dips: the mean of the two ends.
void average_along(std::vector<float>& dip, GridShape shape, bool along_inlines) {
  const auto samples = static_cast<std::size_t>(shape.samples);
  const auto crosslines = static_cast<std::size_t>(shape.crosslines);
  const std::size_t stride = along_inlines ? crosslines * samples : samples;
  for (std::size_t n = 0; n + stride < dip.size(); ++n) {
    if (!along_inlines && (n / samples) % crosslines + 1 == crosslines) continue;
    dip[n] = 0.5f * (dip[n] + dip[n + stride]);
  }
}

}  // namespace

Result<TensorDips> find_dips_by_tensor(const SampleBox& box, const DipOptions& options, const Progress& progress) {
  const auto count = static_cast<std::size_t>(box.shape.count());
  TensorDips result{{box.shape, std::vector<float>(count, 0.0f), std::vector<float>(count, 0.0f)},
                    std::vector<float>(count, 0.0f)};
  StructureTensor tensor(box, options);
  if (!tensor.compute(progress)) return Error{ErrorCode::cancelled, "the search for dips was cancelled"};
  tensor.for_each_node([&](std::int32_t i, std::int32_t j, std::int32_t k) {
    const std::size_t n = box.at(i, j, k);
    const SymmetricEigen eigen = eigen_of(tensor.at(n));
    if (!(eigen.value.x > 0)) return;
    const double rest = std::max(eigen.value.y, 0.0);
    result.planarity[n] = static_cast<float>((eigen.value.x - rest) / eigen.value.x);
    result.dips.to_next_inline[n] = dip_of(eigen.main_vector.x, eigen.main_vector.z);
    result.dips.to_next_crossline[n] = dip_of(eigen.main_vector.y, eigen.main_vector.z);
  });
  average_along(result.dips.to_next_inline, box.shape, true);
  average_along(result.dips.to_next_crossline, box.shape, false);
  return result;
}

}  // namespace geosis
