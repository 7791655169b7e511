#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/structure/link_scan.h"
#include "engine/structure/scan_dips.h"

namespace geosis {
namespace {

/// Normalised correlation.
struct Agreement {
  static constexpr std::size_t kTerms = 3;
  static constexpr std::int32_t kSpacing = DipField::kAgreementSpacing;

  static std::array<float, kTerms> terms(WarpedTrace::Point here, WarpedTrace::Point next) {
    return {here.value * here.value, next.value * next.value, here.value * next.value};
  }

  void store(std::size_t trace, LinkAxis axis, const std::array<std::vector<float>, kTerms>& means, const float* here,
             const float* next) {
    std::uint8_t* to = field.agreements(trace, axis);
    for (std::size_t m = 0; m < means[0].size(); ++m) {
      const std::size_t k = m * static_cast<std::size_t>(kSpacing);
      const float size = std::sqrt(means[0][m] * means[1][m]);
      const bool is_known = size > 0 && !std::isnan(here[k]) && !std::isnan(next[k]);
      const float agreement = is_known ? std::clamp(means[2][m] / size, 0.0f, 1.0f) : 0;
      to[m] = static_cast<std::uint8_t>(std::lround(agreement * 255));
    }
  }

  DipField& field;
};

/// One step of Gauss and Newton for each dip: its two traces should be equal.
struct Refinement {
  static constexpr std::size_t kTerms = 2;
  static constexpr std::int32_t kSpacing = DipField::kDipSpacing;
  static constexpr float kFarthest = 1;           // samples a step
  static constexpr float kLeastContrast = 1e-4f;  // of the samples' variance, as a squared slope

  static std::array<float, kTerms> terms(WarpedTrace::Point here, WarpedTrace::Point next) {
    const float slope = 0.5f * (here.slope + next.slope);
    return {slope * (next.value - here.value), slope * slope};
  }

  void store(std::size_t trace, LinkAxis axis, const std::array<std::vector<float>, kTerms>& means, const float*,
             const float*) {
    std::int16_t* dip = field.dips(trace, axis);
    for (std::size_t m = 0; m < means[0].size(); ++m) {
      const float step = means[0][m] / (means[1][m] + kLeastContrast);
      dip[m] =
          DipField::stored(static_cast<float>(dip[m]) / DipField::kDipScale - std::clamp(step, -kFarthest, kFarthest));
    }
  }

  DipField& field;
};

}  // namespace

Result<void> scan_agreements(const BrickedVolume& measured, const VerticalScan& scan, int threads,
                             const Progress& progress, const std::function<void(double)>& report, DipField& field) {
  Agreement rule{field};
  return LinkScan<Agreement>(measured, scan, threads, field, rule).run(progress, report);
}

Result<void> refine_dips(const BrickedVolume& measured, const VerticalScan& scan, int threads, const Progress& progress,
                         const std::function<void(double)>& report, DipField& field) {
  Refinement rule{field};
  return LinkScan<Refinement>(measured, scan, threads, field, rule).run(progress, report);
}

}  // namespace geosis
