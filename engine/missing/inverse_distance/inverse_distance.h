#pragma once

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/base/vec3.h"
#include "engine/missing/gaps/gap_box.h"
#include "engine/missing/inverse_distance/sample_pyramid.h"
#include "engine/volume/bricks.h"

namespace geosis {

/// Fills by the normalised radial basis function r^-6 over all valid samples of a volume,
///
///     f = sum(f_n d_n^-6) / sum(d_n^-6),     d^2 = sum_a (h_a * nodes along a)^2.
///
/// Samples of the 3^3 cells round a node are summed one by one, those further away by cells of the pyramid that are at
/// most as long as they are far: their number, spread and first moment, so that the result stays within 1 % of the
/// range of the samples. A node's value depends on the volume alone, not on the box that it is asked for with.
class InverseDistanceFill {
 public:
  /// volume        must outlive the result.
  /// step_lengths  h, above zero; only their ratios count.
  /// errors        malformed_input: a damaged brick.  cancelled.
  /// cost          reads the volume once; memory: 50 bytes per 128 nodes.
  static Result<InverseDistanceFill> build(const BrickedVolume& volume, Vec3d step_lengths, int threads,
                                           Progress& progress);

  /// Fills the wanted nodes, from the volume's samples alone: what the box holds is not read. Nodes keep their starting
  /// value when the volume has no valid sample. Any thread may call it.
  ///
  /// errors  malformed_input: a damaged brick.  cancelled: some nodes are filled.
  /// cost    about 4 us per wanted node where many lie together, 10 us where 1 % are missing; memory: 4 MiB or so.
  Result<void> fill(GapBox& gap, const Progress& progress) const;

 private:
  InverseDistanceFill(const BrickedVolume& volume, SamplePyramid pyramid);

  const BrickedVolume* volume_;
  SamplePyramid pyramid_;
};

}  // namespace geosis
