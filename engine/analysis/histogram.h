#pragma once

#include <cstdint>
#include <vector>

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/volume/bricks.h"

namespace geosis {

inline constexpr int kMaxHistogramBins = 4096;

/// How often values occur: bin b counts the samples with edges[b] <= value < edges[b + 1], the last one its upper edge
/// too.
struct Histogram {
  std::vector<double> edges;         ///< (bins + 1), strictly ascending, equally spaced
  std::vector<std::int64_t> counts;  ///< (bins)
  std::int64_t missing = 0;          ///< NaN samples; counts and missing add up to the nodes of the grid
};

/// Histogram of all nodes of the volume, each counted once, over [smallest, largest] sample. A volume of one value v
/// gets edges from v - h to v + h with h = max(0.5, |v| / 2^20), one without valid samples from 0 to 1.
///
/// bins    1 .. kMaxHistogramBins.
/// errors  invalid_argument: bins.  malformed_input: a damaged brick.  cancelled.
/// cost    one read of the volume, except bricks without valid samples; memory: the counts of each thread. The result
///         is the same for any thread count.
Result<Histogram> count_values(const BrickedVolume& volume, int bins, int threads, Progress& progress);

}  // namespace geosis
