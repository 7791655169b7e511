#pragma once

#include <array>
#include <functional>

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/structure/dip_field.h"
#include "engine/volume/bricks.h"

namespace geosis {

/// The samples that dips are found from.
struct DipSamples {
  const BrickedVolume& samples;             ///< filled as far as may be; NaN = missing
  const BrickedVolume* measured = nullptr;  ///< the same with what was filled still missing; null = nothing was
};

/// The dominant vertical period of the samples, in samples: that of the Ricker wavelet whose neighbours differ as much;
/// 0 when they do not change. Missing samples do not count.
struct VerticalScan {
  double period = 0;
  double mean = 0;       ///< of the valid samples
  double deviation = 0;  ///< their standard deviation
};

/// errors   malformed_input: a damaged brick.  cancelled.
/// cost     one read of the volume, a few planes of it in memory. The same for any number of threads.
Result<VerticalScan> scan_vertically(const BrickedVolume& measured, int threads, const Progress& progress);

/// Dips of all links from the gradient's structure tensor, smoothed by a Gaussian of sigma (2, 2, 3): plane after
/// plane, so that memory is the result and some forty planes. Right up to about a quarter of the vertical period a
/// trace. Gradients in gaps and next to them count next to nothing: dips flow a few traces into them. Where nothing is
/// known they are DipField::kUnknown; agreements are 0.
///
/// scan     of the measured samples.
/// report   told fractions of the work.
/// errors   malformed_input: a damaged brick.  cancelled.
/// cost     about 0.1 us a sample and core. The same for any number of threads, and for samples scaled by a power of
/// two.
/// source   L. J. van Vliet and P. W. Verbeek 1995.
Result<DipField> scan_dips(const DipSamples& input, const VerticalScan& scan, int threads, const Progress& progress,
                           const std::function<void(double)>& report);

/// Fills in the agreements of all links: the normalised correlation of the two traces, warped along the dip to the
/// middle between them, in a Gaussian window of sigma (2, 2, 4); 0 where one of them is missing.
///
/// errors, cost   as scan_dips.
Result<void> scan_agreements(const BrickedVolume& measured, const VerticalScan& scan, int threads,
                             const Progress& progress, const std::function<void(double)>& report, DipField& field);

/// Dips anew where reflectors are so steep that the tensor may have taken the wrong peak: the traces of each link are
/// warped to each other as a whole, by lags of half a sample that change by at most one in two samples and leave the
/// least squared difference, summed over the nine links around; then smoothed and refined by least squares. Right up to
/// DipField::kSteepest; but it drifts, and for gentle dips the tensor is better.
///
/// measured   NaN = missing; a link of missing traces has the dips of those around it.
/// errors     as scan_dips.
/// cost       about 2 us a sample and core; memory: a few planes, then 4 bytes a sample. The same for any number of
///            threads.
/// source     H. Sakoe and S. Chiba 1978.
Result<void> warp_dips(const BrickedVolume& measured, const VerticalScan& scan, int threads, const Progress& progress,
                       const std::function<void(double)>& report, DipField& field);

/// One round of least squares: each dip moves by what makes the two traces agree best around it.
Result<void> refine_dips(const BrickedVolume& measured, const VerticalScan& scan, int threads, const Progress& progress,
                         const std::function<void(double)>& report, DipField& field);

/// Sizes of the known dips of one axis's links: half, 95 % and 99 % of them are smaller.
struct DipQuantiles {
  double median = 0, p95 = 0, p99 = 0;
  bool operator==(const DipQuantiles&) const = default;
};

std::array<DipQuantiles, 2> dip_quantiles(const DipField& field);

/// The share of known dips steeper than `dip`, of the axis with more of them.
double share_steeper_than(const DipField& field, double dip);

/// Gives unknown dips values: those of the nearest known ones at the same depth in the four lateral directions, the
/// nearer the heavier; zero where nothing is known at all.
void spread_dips(DipField& field, int threads);

}  // namespace geosis
