#include "engine/volume/synthetic_survey.h"

#include <algorithm>
#include <cmath>

namespace geosis {
namespace {

// Places are fractions of the survey: u along inlines, v along crosslines, depth along samples.
constexpr double kLayers = 26;         // layers from top to bottom of the survey
constexpr double kChannelDepth = 0.5;  // of the channel's axis, where the folds leave the layers
constexpr double kChannelHalfWidth = 0.11;
constexpr double kChannelHalfThickness = 0.075;
constexpr double kChannelEnd = 0.7;  // where the lobes begin

/// splitmix64's finalizer: neighbouring numbers become unrelated ones.
constexpr std::uint64_t mix(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15U;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9U;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebU;
  return x ^ (x >> 31);
}

/// In [0, 1), from the top 53 bits.
constexpr double unit(std::uint64_t hash) {
  return static_cast<double>(hash >> 11) * 0x1p-53;
}

/// In [0, 1): the seed's number for a purpose and a place.
constexpr double random_at(std::uint64_t seed, std::uint64_t purpose, std::uint64_t place) {
  return unit(mix(mix(mix(seed) ^ purpose) ^ place));
}

enum Purpose : std::uint64_t { layers, phases, lobe_places, dead_traces, noise };

/// Period 1, zero at 0 and 1/2, +-1 between, with a continuous slope: two parabolas instead of a sine.
double wave(double x) {
  const double t = x - std::floor(x);
  return t < 0.5 ? 16 * t * (0.5 - t) : -16 * (t - 0.5) * (1 - t);
}

/// 1 at 0, falling smoothly to 0 at 1 and beyond.
double bump_of_square(double square) {
  const double rest = std::max(0.0, 1 - square);
  return rest * rest;
}

double bump(double x) {
  return bump_of_square(x * x);
}

double smooth_step(double x) {
  const double t = std::clamp(x, 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

double fraction(std::int32_t index, std::int32_t count) {
  return static_cast<double>(index) / (count - 1);
}

}  // namespace

SyntheticSurvey::SyntheticSurvey(const SyntheticSurveyOptions& options) : options_(options) {
  reflectivity_.resize(2 * static_cast<std::size_t>(kLayers));
  for (std::size_t n = 0; n < reflectivity_.size(); ++n) {
    // Signs alternate, so that no two layers melt into one.
    const double size = 0.35 + 0.65 * random_at(options.seed, layers, n);
    reflectivity_[n] = n % 2 == 0 ? size : -size;
  }
  for (std::size_t n = 0; n < phase_.size(); ++n) phase_[n] = random_at(options.seed, phases, n);
  // One lobe at the mouth and two that fan out from it.
  constexpr std::array<Lobe, 3> kFan = {{{0.77, 0.0, 0.2}, {0.85, 0.12, 0.18}, {0.84, -0.13, 0.17}}};
  for (std::size_t n = 0; n < lobes_.size(); ++n) {
    const double along = random_at(options.seed, lobe_places, 2 * n) - 0.5;
    const double across = random_at(options.seed, lobe_places, 2 * n + 1) - 0.5;
    lobes_[n] = {kFan[n].u + 0.04 * along, kFan[n].v + 0.04 * across, kFan[n].radius};
  }
}

bool SyntheticSurvey::has_trace(std::int32_t i, std::int32_t j) const {
  const double u = fraction(i, options_.shape.inlines);
  const double v = fraction(j, options_.shape.crosslines);
  if (options_.polygon) {
    const bool is_cut = u + v < 0.22 || (1 - u) + v < 0.30 || (u > 0.86 && v > 0.8);
    if (is_cut) return false;
  }
  if (options_.holes) {
    const double du = (u - 0.42) / 0.05;
    const double dv = (v - channel_centre(0.42) - 0.04) / 0.055;
    if (du * du + dv * dv < 1) return false;
    const auto place = static_cast<std::uint64_t>(i) * static_cast<std::uint64_t>(options_.shape.crosslines) +
                       static_cast<std::uint64_t>(j);
    if (random_at(options_.seed, dead_traces, place) < 0.001) return false;
  }
  return true;
}

void SyntheticSurvey::fill_trace(std::int32_t i, std::int32_t j, std::span<float> samples) const {
  const double u = fraction(i, options_.shape.inlines);
  const double v = fraction(j, options_.shape.crosslines);
  const double shift = fold(u, v);
  const double fill = options_.kind == SurveyKind::channel ? sand(u, v) : 0;
  const auto trace = mix(static_cast<std::uint64_t>(i) << 32 | static_cast<std::uint64_t>(j));
  for (std::size_t k = 0; k < samples.size(); ++k) {
    const double depth = fraction(static_cast<std::int32_t>(k), options_.shape.samples) - shift;
    // The channel is cut into the layers: deepest in its middle, flat on top.
    const double bright = fill * bump((depth - kChannelDepth) / (kChannelHalfThickness * (0.4 + 0.6 * fill)));
    const double rough = 0.04 * (random_at(options_.seed, noise, trace ^ k) - 0.5);
    samples[k] = static_cast<float>((1 - bright) * 0.42 * reflector(depth * kLayers) + bright + rough);
  }
}

/// How far the layers are pushed down at a place, as a fraction of the survey's depth.
double SyntheticSurvey::fold(double u, double v) const {
  const double du = u - 0.35;
  const double dv = v - 0.6;
  const double dome = -0.14 / (1 + 9 * (du * du + dv * dv));
  return 0.05 * wave(0.9 * u + 0.35 * v + phase_[0]) + 0.03 * wave(1.7 * v - 0.6 * u + phase_[1]) + dome + 0.08 * v;
}

/// Amplitude at a depth counted in layers: the boundaries' coefficients, joined smoothly.
double SyntheticSurvey::reflector(double layer) const {
  const double above = std::floor(layer);
  const auto count = static_cast<std::int64_t>(reflectivity_.size());
  const auto at = [&](double boundary) {
    const auto n = static_cast<std::int64_t>(boundary) % count;
    return reflectivity_[static_cast<std::size_t>(n < 0 ? n + count : n)];
  };
  const double t = smooth_step(layer - above);
  return (1 - t) * at(above) + t * at(above + 1);
}

double SyntheticSurvey::channel_centre(double u) const {
  return 0.5 + 0.2 * wave(1.45 * u + phase_[2]) + 0.05 * wave(3.3 * u + phase_[3]);
}

/// How much channel or lobe there is at a place: 0 ... 1.
double SyntheticSurvey::sand(double u, double v) const {
  // A meander is as wide across its own direction as elsewhere: divide by the slope of the centre line.
  constexpr double kStep = 1.0 / 512;
  const double slope = (channel_centre(u + kStep) - channel_centre(u - kStep)) / (2 * kStep);
  const double across = (v - channel_centre(u)) / std::sqrt(1 + slope * slope);
  const double fade = 1 - smooth_step((u - kChannelEnd) / 0.1);
  // A bar in the middle of the channel: the flow parts around it and joins again.
  const double bar = bump((u - 0.2) / 0.08) * bump(across / 0.035);
  double most = fade * std::max(0.0, bump(across / kChannelHalfWidth) - 1.4 * bar);
  for (const Lobe& lobe : lobes_) {
    const double du = (u - lobe.u) / lobe.radius;
    const double dv = (v - channel_centre(kChannelEnd) - lobe.v) / (1.3 * lobe.radius);
    most = std::max(most, bump_of_square(du * du + dv * dv));
  }
  return most;
}

}  // namespace geosis
