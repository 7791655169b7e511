#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "engine/base/parallel.h"
#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/isosurface/extract.h"
#include "engine/volume/bricks.h"
#include "engine/volume/grid.h"

namespace geosis {

/// errors   invalid_argument: the range or the region makes no sense for a volume of that shape.
Result<void> check_request(GridShape shape, IsoRange range, const ExtractOptions& options);

/// Bricks that may hold some of the surface, by the index alone; neighbours in the list are neighbours in space.
std::vector<std::size_t> active_bricks(const BrickedVolume& volume, IsoRange range, const ExtractOptions& options);

/// The other bricks that hold a node in range and a cell of the region, in the same kind of order. With cap all their
/// nodes are in range, and the body goes on all around them.
std::vector<std::size_t> quiet_bricks(const BrickedVolume& volume, IsoRange range, const ExtractOptions& options);

/// Calls worker(n) for every n below count. The first error in the order of n wins.
///
/// make_worker   gives one thread its worker: an object with buffers of its own, Result<void> operator()(std::size_t n)
/// errors        those of the workers; cancelled.
template <class MakeWorker>
Result<void> sweep_bricks(std::size_t count, int threads, Progress& progress, const MakeWorker& make_worker) {
  std::vector<std::optional<Error>> errors(count);
  std::atomic<std::size_t> next{0}, done{0};
  std::atomic<bool> failed{false};
  const std::size_t workers = std::min<std::size_t>(count, static_cast<std::size_t>(std::max(threads, 1)));
  parallel_for(workers, threads, [&](std::size_t) {
    auto worker = make_worker();
    for (std::size_t n; !failed && (n = next++) < count;) {
      if (progress.cancelled()) errors[n] = Error{ErrorCode::cancelled, "extraction was cancelled"};
      if (!errors[n]) {
        if (auto made = worker(n); !made) errors[n] = std::move(made).error();
      }
      if (errors[n]) failed = true;
      progress.report("extract", static_cast<double>(++done) / static_cast<double>(count));
    }
  });
  for (auto& error : errors) {
    if (error) return *std::move(error);
  }
  return {};
}

}  // namespace geosis
