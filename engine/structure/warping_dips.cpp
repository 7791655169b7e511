#include <algorithm>
#include <cmath>
#include <cstddef>

#include "engine/base/parallel.h"
#include "engine/structure/dips.h"
#include "engine/structure/sample_scale.h"
#include "engine/structure/smoothing.h"
#include "engine/structure/warped_trace.h"

namespace geosis {
namespace {

constexpr int kRounds = 4;
constexpr Vec3d kWindow = {2, 2, 4};
constexpr std::size_t kPad = 5;          // half the steepest dip and the cubic's reach
constexpr double kLeastContrast = 1e-3;  // of the box's mean squared slope: below it, dips rather stay where they are

/// The links of one lateral direction: from each trace to the one `stride` nodes on.
class Links {
 public:
  Links(const SampleBox& box, const DipOptions& options, bool along_inlines)
      : box_(box),
        options_(options),
        along_inlines_(along_inlines),
        samples_(static_cast<std::size_t>(box.shape.samples)),
        stride_(samples_ * (along_inlines ? static_cast<std::size_t>(box.shape.crosslines) : 1)),
        scale_(power_of_two_scale(box.value)) {}

  /// std::nullopt-like empty result when cancelled.
  std::vector<float> dips(const Progress& progress) {
    const auto count = static_cast<std::size_t>(box_.shape.count());
    std::vector<float> dip(count, 0.0f), weight(count), pull(count), stiffness(count);
    fill_weights(weight);
    if (!smooth_field(weight, progress)) return {};
    float least = 0;
    for (int round = 0; round < kRounds; ++round) {
      fill_equations(dip, pull, stiffness);
      if (round == 0) least = least_stiffness(stiffness);
      if (!smooth_field(pull, progress) || !smooth_field(stiffness, progress)) return {};
      for (std::size_t n = 0; n < count; ++n) {
        if (!(weight[n] > 0)) continue;
        const float resistance = stiffness[n] / weight[n] + least;
        if (!(resistance > 0)) continue;
        dip[n] = std::clamp(dip[n] - pull[n] / weight[n] / resistance, -kSteepestDip, kSteepestDip);
      }
    }
    return dip;
  }

 private:
  bool has_link(std::size_t i, std::size_t j) const {
    return along_inlines_ ? i + 1 < static_cast<std::size_t>(box_.shape.inlines)
                          : j + 1 < static_cast<std::size_t>(box_.shape.crosslines);
  }

  bool smooth_field(std::vector<float>& field, const Progress& progress) const {
    if (progress.cancelled()) return false;
    smooth(field, box_.shape, kWindow, options_.threads);
    return true;
  }

  /// Calls row(first node of the trace, whether it has a link) for every trace.
  template <class Row>
  void for_each_trace(const Row& row) const {
    const auto crosslines = static_cast<std::size_t>(box_.shape.crosslines);
    parallel_for(static_cast<std::size_t>(box_.shape.inlines), options_.threads, [&](std::size_t i) {
      for (std::size_t j = 0; j < crosslines; ++j) row((i * crosslines + j) * samples_, has_link(i, j));
    });
  }

  float link_weight(std::size_t n) const {
    const float a = box_.value[n], b = box_.value[n + stride_];
    if (!std::isfinite(a) || !std::isfinite(b)) return 0;
    if (options_.measured.empty()) return 1;
    return options_.measured[n] != 0 && options_.measured[n + stride_] != 0 ? 1 : options_.filled_weight;
  }

  void fill_weights(std::vector<float>& weight) const {
    for_each_trace([&](std::size_t first, bool linked) {
      for (std::size_t n = first; n < first + samples_; ++n) weight[n] = linked ? link_weight(n) : 0;
    });
  }

  /// One Gauss-Newton step per node: pull / stiffness is what the dip should fall by.
  void fill_equations(const std::vector<float>& dip, std::vector<float>& pull, std::vector<float>& stiffness) const {
    for_each_trace([&](std::size_t first, bool linked) {
      if (!linked) {
        std::fill_n(pull.begin() + static_cast<std::ptrdiff_t>(first), samples_, 0.0f);
        std::fill_n(stiffness.begin() + static_cast<std::ptrdiff_t>(first), samples_, 0.0f);
        return;
      }
      thread_local PaddedTrace<kPad> here, next;
      here.load(&box_.value[first], samples_, scale_);
      next.load(&box_.value[first + stride_], samples_, scale_);
      for (std::size_t k = 0; k < samples_; ++k) {
        const std::size_t n = first + k;
        const auto a = here.point(k, -0.5f * dip[n]), b = next.point(k, 0.5f * dip[n]);
        const float slope = 0.5f * (a.slope + b.slope), difference = b.value - a.value;
        const float weight = link_weight(n);
        const bool is_usable = weight > 0 && std::isfinite(slope) && std::isfinite(difference);
        pull[n] = is_usable ? weight * slope * difference : 0;
        stiffness[n] = is_usable ? weight * slope * slope : 0;
      }
    });
  }

  float least_stiffness(const std::vector<float>& stiffness) const {
    double sum = 0;
    for (const float s : stiffness) sum += s;
    return static_cast<float>(kLeastContrast * sum / static_cast<double>(stiffness.size()));
  }

  const SampleBox& box_;
  const DipOptions& options_;
  bool along_inlines_;
  std::size_t samples_, stride_;
  double scale_;
};

}  // namespace

Result<Dips> find_dips_by_warping(const SampleBox& box, const DipOptions& options, const Progress& progress) {
  Dips dips{box.shape, {}, {}};
  if (box.value.empty()) return dips;
  dips.to_next_inline = Links(box, options, true).dips(progress);
  if (!dips.to_next_inline.empty()) dips.to_next_crossline = Links(box, options, false).dips(progress);
  if (dips.to_next_crossline.empty()) return Error{ErrorCode::cancelled, "the search for dips was cancelled"};
  return dips;
}

}  // namespace geosis
