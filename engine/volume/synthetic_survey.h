#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/volume/grid.h"

namespace geosis {

enum class SurveyKind {
  channel,     ///< a bright meandering channel that ends in lobes, between folded reflectors
  reflectors,  ///< the folded reflectors alone
};

struct SyntheticSurveyOptions {
  GridShape shape = {160, 200, 160};  ///< at least 2 nodes an axis
  SurveyKind kind = SurveyKind::channel;
  std::uint64_t seed = 1;
  bool polygon = true;  ///< the survey's outline is a polygon, not the whole rectangle
  bool holes = true;    ///< dead traces inside the outline: one patch that crosses the channel, and single ones
};

/// A made-up amplitude survey with a known kind of body in it, for samples, tests and benchmarks. Reflectors stay
/// within about +-0.45; channel and lobes reach 1. The same samples on every machine: only + - * / and integer hashes.
class SyntheticSurvey {
 public:
  explicit SyntheticSurvey(const SyntheticSurveyOptions& options);

  bool has_trace(std::int32_t i, std::int32_t j) const;
  /// samples   shape.samples amplitudes of the trace at (i, j), whether or not the survey has it.
  void fill_trace(std::int32_t i, std::int32_t j, std::span<float> samples) const;

 private:
  struct Lobe {
    double u, v, radius;
  };

  double fold(double u, double v) const;
  double reflector(double layer) const;
  double channel_centre(double u) const;
  double sand(double u, double v) const;

  SyntheticSurveyOptions options_;
  std::vector<double> reflectivity_;  // one coefficient a layer boundary, in [-1, 1]
  std::array<double, 4> phase_;       // of the folds and the meanders, in [0, 1)
  std::array<Lobe, 3> lobes_;
};

}  // namespace geosis
