#pragma once

#include <cstdint>
#include <vector>

#include "engine/volume/grid.h"
#include "tests/support/scalar_field.h"

namespace geosis::test {

enum class Layering {
  gentle,   ///< folds, dips up to about 0.6 samples a trace
  steep,    ///< folds, dips up to about 1.8
  growth,   ///< layers that thicken with depth on one side and thin on the other
  faulted,  ///< gentle folds, cut by two faults of 7 and 5 samples that go through
  plane,    ///< one dip everywhere, from inline to inline
};

struct LayeredOptions {
  GridShape shape = {100, 100, 160};
  Layering layering = Layering::gentle;
  double dip = 0;       ///< of `plane`, samples a trace
  double noise = 0.12;  ///< of the samples' deviation
  std::uint64_t seed = 1;
};

/// Reflectors of which it is known where each one lies. Amplitudes are a random reflectivity under a wavelet, with a
/// dominant period of about 14 samples.
class LayeredTruth {
 public:
  explicit LayeredTruth(const LayeredOptions& options);

  const LayeredOptions& options() const { return options_; }
  /// The layer that lies at a depth on a trace; rises with the depth.
  double layer_at(double i, double j, double depth) const;
  /// How the layer rises with depth there.
  double layers_a_sample(double i, double j) const;
  /// Dip of a link at its middle, samples a trace. Across a fault: as if it were not there.
  double dip_to_next_inline(std::int32_t i, std::int32_t j, double depth) const;
  double dip_to_next_crossline(std::int32_t i, std::int32_t j, double depth) const;
  /// Which side of each fault the trace lies on: 0 ... 3.
  int block(std::int32_t i, std::int32_t j) const;

  ScalarField samples() const;

 private:
  double fold(double i, double j) const;
  double amplitude(double layer) const;

  LayeredOptions options_;
  std::vector<double> wave_;  // amplitude, kStepsALayer a layer
  double phase_[2] = {};
};

}  // namespace geosis::test
