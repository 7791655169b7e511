#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/volume/sample_box.h"

namespace geosis {

/// Dips beyond this many samples per trace are not looked for; found ones are cut to it.
inline constexpr float kSteepestDip = 5;

/// How the reflectors of a box of samples run from trace to trace. All arrays (inlines, crosslines, samples) of the
/// box, sample fastest, finite.
///
/// A dip belongs to the link between two neighbouring traces: the reflector that crosses the middle between traces (i,
/// j) and (i + 1, j) at depth k is at k - p/2 on the former and at k + p/2 on the latter, p = to_next_inline at (i, j,
/// k). The last plane of to_next_inline has no link; it holds the nearest links' dip, for whoever walks outwards.
/// Likewise to_next_crossline.
struct Dips {
  GridShape shape;
  std::vector<float> to_next_inline, to_next_crossline;  ///< samples per trace
};

/// From the structure tensor: dips, and how much the samples look like parallel planes there.
struct TensorDips {
  Dips dips;
  std::vector<float> planarity;  ///< in [0, 1]: (l1 - l2) / l1 of the tensor's eigenvalues; 0 without any contrast
};

struct DipOptions {
  /// As box.value: other than zero where a sample is measured, 0 where it was filled. Empty: all are measured.
  /// NaN samples never count.
  std::span<const std::uint8_t> measured{};
  float filled_weight = 0.003f;  ///< of what filled samples say, beside 1 for measured ones; dips flow into gaps
  int threads = 1;
};

/// Dips by least squares: each link's dip is moved until the two traces agree best around it, four times from zero.
/// Right up to about half the vertical period a trace; up to the very rim of gaps.
///
/// errors   cancelled.
/// cost     about 0.4 us a node and core; 3 floats a node beside the result. The same for any number of threads, and
///          for samples scaled by a power of two.
/// source   B. D. Lucas and T. Kanade 1981, with the sums weighted by a Gaussian of sigma (2, 2, 4).
Result<Dips> find_dips_by_warping(const SampleBox& box, const DipOptions& options, const Progress& progress);

/// Dips and planarity from the gradient's structure tensor, smoothed by a Gaussian of sigma (2, 2, 3). More exact than
/// warping for gentle dips, blind in gaps and next to them.
///
/// errors   cancelled.
/// cost     about 0.5 us a node and core; 8 floats a node beside the result. The same for any number of threads, and
///          for samples scaled by a power of two.
/// source   L. J. van Vliet and P. W. Verbeek 1995.
Result<TensorDips> find_dips_by_tensor(const SampleBox& box, const DipOptions& options, const Progress& progress);

}  // namespace geosis
