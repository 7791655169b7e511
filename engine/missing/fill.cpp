#include "engine/missing/fill.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/parallel.h"
#include "engine/missing/axis_barycentre.h"
#include "engine/missing/brick_nodes.h"
#include "engine/missing/file/fill_writer.h"
#include "engine/missing/fill_gaps.h"
#include "engine/missing/fill_share.h"
#include "engine/missing/gaps/distance_limit.h"
#include "engine/missing/gaps/outline.h"
#include "engine/missing/gaps/survey_scan.h"
#include "engine/missing/linear_fill.h"
#include "engine/missing/solve_gap.h"

namespace geosis {
namespace {

// Shares of the stage: the scan ends, records are written, gaps are solved (only then), the index is made.
constexpr double kScanned = 0.3, kLinear = 0.95, kStarted = 0.4, kSolved = 0.95;

Error cancelled() {
  return {ErrorCode::cancelled, "cancelled"};
}

Result<void> check(const FillOptions& options) {
  if (options.method == FillMethod::none) return Error{ErrorCode::invalid_argument, "filling with method none"};
  if (options.max_distance && !(*options.max_distance > 0))
    return Error{ErrorCode::invalid_argument,
                 "filling up to max_distance " + std::to_string(*options.max_distance) + "; expected above 0"};
  return {};
}

/// False: every sample is measured, or none.
bool has_gaps(const BrickedVolume& volume) {
  bool missing = false, valid = false;
  for (std::size_t brick = 0; brick < volume.brick_count(); ++brick) {
    const BrickSummary summary = volume.summary(brick);
    missing = missing || summary.has_missing;
    valid = valid || !summary.all_missing;
  }
  return missing && valid;
}

/// A file without records.
Result<std::unique_ptr<FilledVolume>> fill_nothing(const BrickedVolume& volume,
                                                   const std::optional<std::filesystem::path>& path) {
  auto writer = FillWriter::create(volume, std::vector<std::uint32_t>(volume.brick_count()), path);
  if (!writer) return std::move(writer).error();
  for (std::size_t brick = 0; brick < volume.brick_count(); ++brick)
    writer->index(brick, volume.summary(brick).has_missing);
  return std::move(*writer).finish(0);
}

/// Missing nodes inside the outline.
BitLines fillable_nodes(const BitLines& valid, const std::vector<std::uint8_t>& inside) {
  BitLines nodes(inside.size(), valid.length());
  for (std::size_t trace = 0; trace < inside.size(); ++trace) {
    if (!inside[trace]) continue;
    const auto line = nodes.line(trace);
    std::ranges::transform(valid.line(trace), line.begin(), [](std::uint64_t word) { return ~word; });
    line.back() &= nodes.last_word();
  }
  return nodes;
}

/// work(brick) for all bricks, on several threads, while nobody cancels.
template <class Work>
void for_bricks(std::size_t bricks, int threads, FillShare& share, const Work& work) {
  parallel_for(bricks, threads, [&](std::size_t brick) {
    if (share.cancelled()) return;
    work(brick);
    share.done();
  });
}

/// Filling of one volume, whose scan is done.
class Filling {
 public:
  Filling(const BrickedVolume& volume, const FillOptions& options, const SurveyScan& scan, int threads,
          Progress& progress)
      : volume_(volume),
        options_(options),
        scan_(scan),
        threads_(threads),
        progress_(progress),
        inside_(traces_inside(volume.shape(), scan.valid)),
        nodes_(fillable_nodes(scan.valid, inside_)),
        barycentre_(scan.views, scan.valid, scan.step_lengths, inside_) {}

  Result<std::unique_ptr<FilledVolume>> run(const std::optional<std::filesystem::path>& path) {
    std::optional<GapMethod> method;
    if (options_.method == FillMethod::rbf) {
      auto made = make_gap_method(volume_, options_, scan_.step_lengths, threads_, progress_);
      if (!made) return std::move(made).error();
      method = *std::move(made);
    }
    const BitLines fillable = method && options_.max_distance ? nodes_ : BitLines();
    if (options_.max_distance)
      drop_beyond(*options_.max_distance, volume_.shape(), scan_.valid, nodes_, threads_, progress_);
    if (progress_.cancelled()) return cancelled();
    auto writer = FillWriter::create(volume_, count_records(), path);
    if (!writer) return std::move(writer).error();
    write_linear(*writer, method ? kStarted : kLinear);
    if (method) {
      const GapSurvey survey{volume_, barycentre_, options_.max_distance ? fillable : nodes_};
      if (auto solved =
              fill_gaps(survey, method->solve, {.wide = method->wide}, *writer, threads_, progress_, kStarted, kSolved);
          !solved)
        return std::move(solved).error();
    }
    index(*writer, method ? kSolved : kLinear);
    if (progress_.cancelled()) return cancelled();
    return std::move(*writer).finish(nodes_.count());
  }

 private:
  const BrickLayout& layout() const { return scan_.views.layout(); }

  std::vector<std::uint32_t> count_records() const {
    std::vector<std::uint32_t> counts(layout().brick_count());
    parallel_for(counts.size(), threads_,
                 [&](std::size_t brick) { counts[brick] = count_nodes(layout(), brick, nodes_); });
    return counts;
  }
  void write_linear(FillWriter& writer, double end) {
    FillShare share(progress_, kScanned, end, layout().brick_count());
    for_bricks(layout().brick_count(), threads_, share,
               [&](std::size_t brick) { fill_brick(barycentre_, nodes_, layout(), brick, writer, progress_); });
  }
  void index(FillWriter& writer, double begin) {
    FillShare share(progress_, begin, 1, layout().brick_count());
    for_bricks(layout().brick_count(), threads_, share, [&](std::size_t brick) {
      const std::uint32_t valid = count_nodes(layout(), brick, scan_.valid);
      const auto all = static_cast<std::size_t>(layout().extent(layout().place(brick)).count());
      writer.index(brick, valid + writer.records(brick).size() < all);
    });
  }

  const BrickedVolume& volume_;
  const FillOptions& options_;
  const SurveyScan& scan_;
  int threads_;
  Progress& progress_;
  std::vector<std::uint8_t> inside_;
  BitLines nodes_;  ///< to fill
  AxisBarycentre barycentre_;
};

}  // namespace

Result<std::unique_ptr<FilledVolume>> fill_missing(const BrickedVolume& volume, const FillOptions& options,
                                                   const std::optional<std::filesystem::path>& path, int threads,
                                                   Progress& progress) {
  if (auto valid = check(options); !valid) return std::move(valid).error();
  if (!has_gaps(volume)) return fill_nothing(volume, path);
  auto scan = scan_survey(volume, threads, progress);
  if (!scan) return std::move(scan).error();
  return Filling(volume, options, *scan, threads, progress).run(path);
}

}  // namespace geosis
