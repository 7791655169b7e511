#include "tests/support/layered_truth.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/support/random.h"

namespace geosis::test {
namespace {

constexpr int kFirstLayer = -1200, kLayers = 3000;
constexpr int kStepsALayer = 8;
constexpr double kPeriod = 14;  // of the wavelet

double ricker(double x) {
  const double a = std::numbers::pi * x / kPeriod;
  return (1 - 2 * a * a) * std::exp(-a * a);
}

double turn(double x) {
  return std::sin(2 * std::numbers::pi * x);
}

}  // namespace

LayeredTruth::LayeredTruth(const LayeredOptions& options) : options_(options) {
  Random random(options.seed);
  for (double& phase : phase_) phase = random.unit();
  std::vector<double> reflectivity(kLayers);
  for (double& r : reflectivity) {
    const double x = 2 * random.unit() - 1;
    r = x * std::abs(x);
  }
  wave_.resize(static_cast<std::size_t>(kLayers) * kStepsALayer);
  for (std::size_t n = 0; n < wave_.size(); ++n) {
    const auto here = static_cast<int>(n) / kStepsALayer;
    for (int m = std::max(here - 24, 0); m < std::min(here + 25, kLayers); ++m) {
      wave_[n] += reflectivity[static_cast<std::size_t>(m)] * ricker(static_cast<double>(n) / kStepsALayer - m);
    }
  }
}

/// Samples by which layers are pushed down.
double LayeredTruth::fold(double i, double j) const {
  switch (options_.layering) {
    case Layering::plane:
      return options_.dip * i;
    case Layering::steep:
      return 18 * turn((0.8 * i + 0.6 * j) / 75 + phase_[0]) + 9 * turn((0.5 * i - 0.87 * j) / 50 + phase_[1]);
    case Layering::gentle:
    case Layering::growth:
      return 8 * turn((0.8 * i + 0.6 * j) / 105 + phase_[0]) + 4 * turn((0.5 * i - 0.87 * j) / 70 + phase_[1]);
    case Layering::faulted:
      return 5 * turn((0.8 * i + 0.6 * j) / 105 + phase_[0]) + 2.5 * turn((0.5 * i - 0.87 * j) / 70 + phase_[1]);
  }
  return 0;
}

int LayeredTruth::block(std::int32_t i, std::int32_t j) const {
  if (options_.layering != Layering::faulted) return 0;
  const double u = static_cast<double>(i) / options_.shape.inlines,
               v = static_cast<double>(j) / options_.shape.crosslines;
  return (u + 0.2 * v > 0.42 ? 1 : 0) + (v - 0.3 * u > 0.45 ? 2 : 0);
}

double LayeredTruth::layers_a_sample(double i, double j) const {
  return options_.layering == Layering::growth ? 1 - fold(i, j) / options_.shape.samples : 1;
}

double LayeredTruth::layer_at(double i, double j, double depth) const {
  if (options_.layering == Layering::growth) return depth * layers_a_sample(i, j);
  const int at = block(static_cast<std::int32_t>(std::lround(i)), static_cast<std::int32_t>(std::lround(j)));
  const double thrown = (at & 1 ? 7 : 0) + (at & 2 ? 5 : 0);
  return depth - fold(i, j) - thrown;
}

double LayeredTruth::dip_to_next_inline(std::int32_t i, std::int32_t j, double depth) const {
  const double fall = fold(i + 1, j) - fold(i, j);
  return options_.layering == Layering::growth ? fall * depth / options_.shape.samples / layers_a_sample(i + 0.5, j)
                                               : fall;
}

double LayeredTruth::dip_to_next_crossline(std::int32_t i, std::int32_t j, double depth) const {
  const double fall = fold(i, j + 1) - fold(i, j);
  return options_.layering == Layering::growth ? fall * depth / options_.shape.samples / layers_a_sample(i, j + 0.5)
                                               : fall;
}

double LayeredTruth::amplitude(double layer) const {
  const double place = std::clamp((layer - kFirstLayer) * kStepsALayer, 0.0, static_cast<double>(wave_.size() - 2));
  const auto below = static_cast<std::size_t>(place);
  return wave_[below] + (wave_[below + 1] - wave_[below]) * (place - static_cast<double>(below));
}

ScalarField LayeredTruth::samples() const {
  ScalarField field(options_.shape);
  double sum = 0, squares = 0;
  for_each_node(options_.shape, [&](GridIndex n) {
    const double value = amplitude(layer_at(n.i, n.j, n.k));
    field.at(n) = static_cast<float>(value);
    sum += value;
    squares += value * value;
  });
  const auto count = static_cast<double>(field.samples.size());
  const double deviation = std::sqrt(std::max(squares / count - sum * sum / count / count, 0.0));
  Random random(options_.seed ^ 0x5eedU);
  for (float& sample : field.samples) {
    double noise = 0;  // nearly normal, of deviation 1
    for (int n = 0; n < 12; ++n) noise += random.unit();
    sample += static_cast<float>(options_.noise * deviation * (noise - 6));
  }
  return field;
}

}  // namespace geosis::test
