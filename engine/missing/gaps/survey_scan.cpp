#include "engine/missing/gaps/survey_scan.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
#include <optional>
#include <utility>
#include <vector>

#include "engine/base/parallel.h"
#include "engine/missing/fill_share.h"
#include "engine/missing/step_lengths.h"

namespace geosis {
namespace {

constexpr double kShare = 0.3;  ///< of the stage
// Step lengths of big surveys are taken from about so many of their traces: that is plenty.
constexpr std::size_t kTracesForSteps = 16'384;

double middle_of_range(const BrickedVolume& volume) {
  const ValueRange all = value_range(volume);
  return all.min <= all.max ? (double{all.min} + double{all.max}) / 2 : 0;
}

/// Of how many traces one is summed.
std::uint32_t row_share(GridShape shape) {
  const std::size_t traces = static_cast<std::size_t>(shape.inlines) * static_cast<std::size_t>(shape.crosslines);
  return static_cast<std::uint32_t>(std::max<std::size_t>(traces / kTracesForSteps, 1));
}

/// Bit k of the result: sample k of the row is valid. n <= 64.
std::uint64_t valid_bits(const float* row, std::int32_t n) {
  std::array<std::uint8_t, 64> valid{};
  for (std::int32_t k = 0; k < n; ++k) valid[static_cast<std::size_t>(k)] = row[k] == row[k];
  std::uint64_t bits = 0;
  for (std::size_t byte = 0; byte < 8; ++byte) {
    std::uint64_t eight;
    std::memcpy(&eight, valid.data() + 8 * byte, sizeof eight);
    // Moves the lowest bit of byte b to bit 56 + b.
    bits |= (eight * 0x0102040810204080 >> 56) << 8 * byte;
  }
  return bits;
}

void put_bits(std::span<std::uint64_t> line, std::int32_t at, std::uint64_t bits) {
  const auto word = static_cast<std::size_t>(at) / 64;
  line[word] |= bits << at % 64;
  if (at % 64 != 0 && word + 1 < line.size()) line[word + 1] |= bits >> (64 - at % 64);
}

/// One column of bricks after the other, so that nobody else writes to its traces.
class Scanner {
 public:
  Scanner(const BrickedVolume& volume, SurveyScan& scan)
      : volume_(volume),
        scan_(scan),
        layout_(scan.views.layout()),
        pivot_(middle_of_range(volume)),
        row_share_(row_share(layout_.shape())),
        sums_(layout_.brick_count()) {}

  Result<void> read_column(std::size_t column, const FillShare& share) {
    const GridShape grid = layout_.grid();
    for (std::int32_t bk = 0; bk < grid.samples && !share.cancelled(); ++bk) {
      const std::size_t brick = column * static_cast<std::size_t>(grid.samples) + static_cast<std::size_t>(bk);
      if (volume_.summary(brick).all_missing) continue;
      if (auto taken = scan_.views.take(volume_, brick); !taken) return taken;
      sums_[brick] = sums_of(brick, 1);
      mark_valid(brick);
    }
    return {};
  }
  void sum_column_again(std::size_t column) {
    const auto bricks = static_cast<std::size_t>(layout_.grid().samples);
    for (std::size_t brick = column * bricks; brick < (column + 1) * bricks; ++brick)
      sums_[brick] = scan_.views.view(brick).samples == nullptr ? SampleSums() : sums_of(brick, 2);
  }
  SampleSums total() const {
    SampleSums all;
    for (const SampleSums& brick : sums_) all += brick;
    return all;
  }

 private:
  SampleSums sums_of(std::size_t brick, int lag) const {
    const GridIndex place = layout_.place(brick);
    const GridShape grid = layout_.grid();
    return sum_samples(scan_.views.view(brick),
                       {place.i + 1 == grid.inlines, place.j + 1 == grid.crosslines, place.k + 1 == grid.samples},
                       volume_.summary(brick).has_missing, lag, pivot_, row_share_);
  }
  void mark_valid(std::size_t brick) {
    const BrickView& view = scan_.views.view(brick);
    const GridIndex place = layout_.place(brick);
    const bool whole = !volume_.summary(brick).has_missing;
    const std::int32_t n = view.extent.samples;
    const std::uint64_t all = n == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << n) - 1;
    // A layer that columns share is marked by the one that it ends: the first.
    for (std::int32_t a = place.i == 0 ? 0 : 1; a < view.extent.inlines; ++a) {
      for (std::int32_t b = place.j == 0 ? 0 : 1; b < view.extent.crosslines; ++b) {
        const float* row = view.samples + (static_cast<std::ptrdiff_t>(a) * view.extent.crosslines + b) * n;
        const std::size_t trace =
            static_cast<std::size_t>(view.first.i + a) * layout_.shape().crosslines + (view.first.j + b);
        put_bits(scan_.valid.line(trace), view.first.k, whole ? all : valid_bits(row, n));
      }
    }
  }

  const BrickedVolume& volume_;
  SurveyScan& scan_;
  const BrickLayout& layout_;
  double pivot_;
  std::uint32_t row_share_;
  std::vector<SampleSums> sums_;
};

bool lacks_pairs(const SampleSums& sums) {
  return std::ranges::any_of(sums.axis, [](const PairSum& axis) { return axis.pairs == 0; });
}

}  // namespace

Result<SurveyScan> scan_survey(const BrickedVolume& volume, int threads, Progress& progress) {
  const GridShape shape = volume.shape();
  SurveyScan scan{
      BrickViews(volume),
      BitLines(static_cast<std::size_t>(shape.inlines) * static_cast<std::size_t>(shape.crosslines), shape.samples),
      {}};
  const GridShape grid = scan.views.layout().grid();
  const std::size_t columns = static_cast<std::size_t>(grid.inlines) * static_cast<std::size_t>(grid.crosslines);
  Scanner scanner(volume, scan);
  std::vector<std::optional<Error>> errors(columns);
  FillShare share(progress, 0, kShare, columns);
  parallel_for(columns, threads, [&](std::size_t column) {
    if (auto read = scanner.read_column(column, share); !read) errors[column] = std::move(read).error();
    share.done();
  });
  for (std::optional<Error>& error : errors)
    if (error) return *std::move(error);
  const SampleSums neighbours = scanner.total();
  SampleSums lag_two;
  if (lacks_pairs(neighbours)) {
    parallel_for(columns, threads, [&](std::size_t column) {
      if (!progress.cancelled()) scanner.sum_column_again(column);
    });
    lag_two = scanner.total();
  }
  if (progress.cancelled()) return Error{ErrorCode::cancelled, "cancelled"};
  scan.step_lengths = step_lengths(neighbours, lag_two);
  return scan;
}

}  // namespace geosis
