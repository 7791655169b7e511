#include "engine/missing/plate/steered_plate.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include "engine/missing/plate/steered_energy.h"
#include "engine/missing/plate/steered_paths.h"
#include "engine/missing/plate/thin_plate.h"
#include "engine/structure/dips.h"
#include "engine/structure/sample_scale.h"

namespace geosis {
namespace {

constexpr std::int32_t kLeastSamples = 4;  // of a trace: cubics go through so many along it
constexpr double kLeastPlanarity = 0.5;
constexpr float kFirstWeight = 0.003f;    // of the first guess in the dips
constexpr float kRepeatedWeight = 0.02f;  // of the filled samples in the dips, the second time
// The first fill only serves to find the dips again. The second stops early too: further on, errors of the dips are all
// that the plate bends to (residual 1e-3 for 1e-2: as often worse as better, in three times the time).
constexpr double kFirstTolerance = 50, kSecondTolerance = 10;  // in the caller's
constexpr int kMostIterations = 400;
constexpr double kRounding = 2e-7;  // of samples up to 1, in float

/// Whether somewhere a square of kLeastSteeredTraces x kLeastSteeredTraces traces each lack a sample.
bool is_wide(const GapBox& gap) {
  const GridShape shape = gap.samples.shape;
  // side[j] is that of the largest square whose last corner is the trace (i, j).
  std::vector<std::int32_t> side(static_cast<std::size_t>(shape.crosslines), 0), above;
  for (std::int32_t i = 0; i < shape.inlines; ++i) {
    above = side;
    for (std::int32_t j = 0; j < shape.crosslines; ++j) {
      const auto first = gap.state.begin() + static_cast<std::ptrdiff_t>(gap.samples.at(i, j, 0));
      const bool lacks = std::find(first, first + shape.samples, NodeState::wanted) != first + shape.samples;
      side[j] = !lacks ? 0 : i == 0 || j == 0 ? 1 : 1 + std::min({above[j], above[j - 1], side[j - 1]});
      if (side[j] >= kLeastSteeredTraces) return true;
    }
  }
  return false;
}

std::vector<std::uint8_t> known_nodes(const GapBox& gap) {
  std::vector<std::uint8_t> known(gap.state.size());
  for (std::size_t n = 0; n < known.size(); ++n) known[n] = gap.state[n] == NodeState::known ? 1 : 0;
  return known;
}

/// A gap whose samples are being found, scaled to sizes up to 1.
class SteeredFill {
 public:
  SteeredFill(const GapBox& gap, const Vec3d& step_lengths, const ThinPlateOptions& options, const Progress& progress)
      : gap_(gap), step_lengths_(step_lengths), options_(options), progress_(progress), known_(known_nodes(gap)) {
    scale_ = power_of_two_scale(gap.samples.value);
    box_ = {gap.samples.first, gap.samples.shape, std::vector<float>(gap.samples.value.size())};
    for (std::size_t n = 0; n < box_.value.size(); ++n) {
      const bool is_there = gap.state[n] != NodeState::absent && std::isfinite(gap.samples.value[n]);
      box_.value[n] =
          is_there ? static_cast<float>(gap.samples.value[n] * scale_) : std::numeric_limits<float>::quiet_NaN();
    }
  }

  /// One fill along the box's dips; false when cancelled.
  bool fill(float weight_of_filled, bool from_start, double tolerance) {
    auto dips = find_dips_by_warping(box_, {.measured = known_, .filled_weight = weight_of_filled}, progress_);
    if (!dips) return false;
    const SteeredPaths paths = follow_dips(*dips);
    *dips = {};
    std::vector<float>& x = box_.value;
    for (float& sample : x) sample = std::isfinite(sample) ? sample : 0;
    const Vec3d steps = steps_along_dips(x, gap_.state, paths, step_lengths_);
    if (from_start) start_along_dips(x, gap_.state, paths, steps);
    x.resize(x.size() + SteeredEnergy::kSlack, 0.0f);
    const bool is_done = minimise(SteeredEnergy(gap_.state, paths, steps), x, tolerance);
    x.resize(gap_.state.size());
    for (std::size_t n = 0; n < x.size(); ++n) {
      if (gap_.state[n] == NodeState::absent) x[n] = std::numeric_limits<float>::quiet_NaN();
    }
    return is_done;
  }

  void store(GapBox& gap) const {
    for (std::size_t n = 0; n < box_.value.size(); ++n) {
      if (gap.state[n] != NodeState::wanted) continue;
      const double value = box_.value[n] / scale_;
      const double found = std::isfinite(value) ? value : double{gap.samples.value[n]};
      gap.samples.value[n] = static_cast<float>(std::clamp(found, double{options_.low}, double{options_.high}));
    }
  }

 private:
  /// Conjugate gradients with the diagonal.
  bool minimise(const SteeredEnergy& energy, std::vector<float>& x, double tolerance) {
    std::vector<float> inverse(x.size()), rest(x.size()), direction(x.size()), product(x.size());
    energy.diagonal(inverse);
    double stiffness = 0;
    for (float& d : inverse) {
      stiffness += d;
      d = d > 0 ? 1 / d : 0;
    }
    energy.gradient(x, rest);
    for (float& r : rest) r = -r;
    double size = weighted_square(rest, inverse);
    if (!(first_size_ > 0)) first_size_ = size;
    const double least = std::max(tolerance * tolerance * first_size_, kRounding * kRounding * stiffness);
    for (std::size_t n = 0; n < x.size(); ++n) direction[n] = inverse[n] * rest[n];
    for (int iteration = 0; iteration < kMostIterations && size > least; ++iteration) {
      if (progress_.cancelled()) return false;
      energy.gradient(direction, product);
      double curvature = 0;
      for (std::size_t n = 0; n < x.size(); ++n) curvature += double{direction[n]} * product[n];
      if (!(curvature > 0)) break;
      const auto step = static_cast<float>(size / curvature);
      for (std::size_t n = 0; n < x.size(); ++n) {
        x[n] += step * direction[n];
        rest[n] -= step * product[n];
      }
      const double before = size;
      size = weighted_square(rest, inverse);
      const auto keep = static_cast<float>(size / before);
      for (std::size_t n = 0; n < x.size(); ++n) direction[n] = inverse[n] * rest[n] + keep * direction[n];
    }
    return true;
  }

  static double weighted_square(const std::vector<float>& a, const std::vector<float>& weight) {
    double sum = 0;
    for (std::size_t n = 0; n < a.size(); ++n) sum += double{a[n]} * a[n] * weight[n];
    return sum;
  }

  const GapBox& gap_;
  const Vec3d& step_lengths_;
  const ThinPlateOptions& options_;
  const Progress& progress_;
  std::vector<std::uint8_t> known_;
  double scale_ = 1;
  SampleBox box_;
  double first_size_ = 0;
};

}  // namespace

bool wants_steering(const GapBox& gap, FillSteering steering, const Progress& progress) {
  switch (steering) {
    case FillSteering::off:
      return false;
    case FillSteering::on:
      return true;
    case FillSteering::automatic:
      break;
  }
  if (!is_wide(gap)) return false;
  const std::vector<std::uint8_t> known = known_nodes(gap);
  const auto found = find_dips_by_tensor(gap.samples, {.measured = known}, progress);
  if (!found) return false;
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t n = 0; n < known.size(); ++n) {
    if (known[n] == 0) continue;
    sum += found->planarity[n];
    ++count;
  }
  return sum > kLeastPlanarity * static_cast<double>(count);
}

void fill_steered_plate(GapBox& gap, const Vec3d& step_lengths, const ThinPlateOptions& options,
                        const Progress& progress) {
  if (gap.samples.shape.samples < kLeastSamples) {
    GapBox level = gap;
    fill_thin_plate(level, step_lengths, options, progress);
    if (!progress.cancelled()) gap = std::move(level);
    return;
  }
  SteeredFill fill(gap, step_lengths, options, progress);
  if (fill.fill(kFirstWeight, true, kFirstTolerance * options.tolerance) &&
      fill.fill(kRepeatedWeight, false, kSecondTolerance * options.tolerance)) {
    fill.store(gap);
  }
}

}  // namespace geosis
