#include "engine/analysis/histogram.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <mutex>
#include <optional>
#include <string>

#include "engine/base/parallel.h"
#include "engine/volume/brick_layout.h"

namespace geosis {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Interval {
  double low, high;
};

Result<Interval> interval_of(const BrickedVolume& volume) {
  double low = kInfinity, high = -kInfinity;
  for (std::size_t brick = 0; brick < volume.brick_count(); ++brick) {
    const BrickSummary summary = volume.summary(brick);
    if (summary.all_missing) continue;
    if (!std::isfinite(summary.range.min) || !std::isfinite(summary.range.max))
      return Error{ErrorCode::malformed_input, "brick file: brick " + std::to_string(brick) + " has samples from " +
                                                   std::to_string(summary.range.min) + " to " +
                                                   std::to_string(summary.range.max) + "; expected finite numbers"};
    low = std::min<double>(low, summary.range.min);
    high = std::max<double>(high, summary.range.max);
  }
  if (low < high) return Interval{low, high};
  if (low > high) return Interval{0, 1};
  const double half = std::max(0.5, std::fabs(low) / (1 << 20));
  return Interval{low - half, high + half};
}

/// Finds the bin of each sample of a row, exactly as the edges say.
class Binning {
 public:
  Binning(Interval interval, int bins) : low_(interval.low), last_(bins - 1) {
    const double width = interval.high - interval.low;
    scale_ = bins / width;
    for (int b = 0; b < bins; ++b) edges_.push_back(interval.low + width * b / bins);
    edges_.push_back(interval.high);
    // Nothing passes the outer fences: the outer bins take whatever lies beyond, and missing samples stay in their
    // slot.
    constexpr double impassable = std::numeric_limits<double>::quiet_NaN();
    fences_ = edges_;
    fences_.front() = fences_.back() = impassable;
    fences_.push_back(impassable);
  }

  const std::vector<double>& edges() const { return edges_; }
  std::size_t slots() const { return edges_.size(); }  ///< the bins, then one slot for missing samples

  void count(const float* row, std::int32_t n, std::int64_t* slots) const {
    std::array<std::int32_t, kBrickSamples> guesses;
    guess(row, n, guesses.data());
    for (std::int32_t k = 0; k < n; ++k) {
      // Rounding puts the guess at most one bin beside the edges' answer; NaN compares false and stays.
      std::int32_t slot = guesses[static_cast<std::size_t>(k)];
      const double value = row[k];
      slot += value >= fences_[static_cast<std::size_t>(slot) + 1];
      slot -= value < fences_[static_cast<std::size_t>(slot)];
      ++slots[slot];
    }
  }

 private:
  // No branches and no tables, so that the compiler may use vectors.
  void guess(const float* row, std::int32_t n, std::int32_t* guesses) const {
    const double low = low_, scale = scale_, last = last_;
    const std::int32_t missing = last_ + 1;
    for (std::int32_t k = 0; k < n; ++k) {
      double position = (static_cast<double>(row[k]) - low) * scale;
      position = position < last ? position : last;
      position = position > 0 ? position : 0;
      const auto bin = static_cast<std::int32_t>(position);
      guesses[k] = row[k] == row[k] ? bin : missing;
    }
  }

  double low_, scale_;
  std::int32_t last_;
  std::vector<double> edges_, fences_;
};

/// Nodes of a brick that no later brick repeats: without its upper layer on each axis where a neighbour follows.
GridShape own_nodes(const BrickLayout& layout, GridIndex place) {
  const GridShape extent = layout.extent(place), grid = layout.grid();
  return {extent.inlines - (place.i + 1 < grid.inlines), extent.crosslines - (place.j + 1 < grid.crosslines),
          extent.samples - (place.k + 1 < grid.samples)};
}

Result<void> count_brick(const BrickedVolume& volume, const BrickLayout& layout, std::size_t number,
                         const Binning& binning, std::vector<std::int64_t>& slots) {
  const GridShape own = own_nodes(layout, layout.place(number));
  if (volume.summary(number).all_missing) {
    slots.back() += own.count();
    return {};
  }
  const auto brick = volume.brick(number);
  if (!brick) return brick.error();
  for (std::int32_t a = 0; a < own.inlines; ++a)
    for (std::int32_t b = 0; b < own.crosslines; ++b)
      binning.count(brick->samples + (a * brick->extent.crosslines + b) * brick->extent.samples, own.samples,
                    slots.data());
  return {};
}

/// All bricks, counted by some threads; sums of integers do not depend on who counted what.
class Count {
 public:
  Count(const BrickedVolume& volume, const Binning& binning, Progress& progress)
      : volume_(volume), layout_(volume.shape()), binning_(binning), progress_(progress), total_(binning.slots()) {}

  Result<std::vector<std::int64_t>> run(int threads) && {
    const std::size_t workers = std::min(volume_.brick_count(), static_cast<std::size_t>(std::max(threads, 1)));
    parallel_for(workers, threads, [this](std::size_t) { work(); });
    if (error_) return *std::move(error_);
    return std::move(total_);
  }

 private:
  void work() {
    std::vector<std::int64_t> slots(total_.size());
    for (std::size_t brick; !failed_ && (brick = next_++) < volume_.brick_count();) {
      if (progress_.cancelled()) return fail({ErrorCode::cancelled, "histogram was cancelled"});
      if (auto counted = count_brick(volume_, layout_, brick, binning_, slots); !counted)
        return fail(std::move(counted).error());
      progress_.report("histogram", static_cast<double>(++done_) / static_cast<double>(volume_.brick_count()));
    }
    const std::scoped_lock lock(mutex_);
    for (std::size_t slot = 0; slot < slots.size(); ++slot) total_[slot] += slots[slot];
  }

  void fail(Error error) {
    const std::scoped_lock lock(mutex_);
    if (!error_) error_ = std::move(error);
    failed_ = true;
  }

  const BrickedVolume& volume_;
  const BrickLayout layout_;
  const Binning& binning_;
  Progress& progress_;
  std::atomic<std::size_t> next_{0}, done_{0};
  std::atomic<bool> failed_{false};
  std::mutex mutex_;  ///< guards what follows
  std::optional<Error> error_;
  std::vector<std::int64_t> total_;
};

}  // namespace

Result<Histogram> count_values(const BrickedVolume& volume, int bins, int threads, Progress& progress) {
  if (bins < 1 || bins > kMaxHistogramBins)
    return Error{ErrorCode::invalid_argument,
                 "histogram of " + std::to_string(bins) + " bins; expected 1.." + std::to_string(kMaxHistogramBins)};
  const auto interval = interval_of(volume);
  if (!interval) return interval.error();
  const Binning binning(*interval, bins);
  auto counted = Count(volume, binning, progress).run(threads);
  if (!counted) return std::move(counted).error();

  Histogram histogram{binning.edges(), std::move(counted).value(), 0};
  histogram.missing = histogram.counts.back();
  histogram.counts.pop_back();
  return histogram;
}

}  // namespace geosis
