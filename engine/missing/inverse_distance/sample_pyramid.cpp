#include "engine/missing/inverse_distance/sample_pyramid.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <mutex>
#include <optional>
#include <utility>

#include "engine/base/parallel.h"
#include "engine/volume/sample_box.h"

namespace geosis {
namespace {

constexpr std::int32_t kStripNodes = 64;  // crosslines that one task reads
constexpr std::int64_t kTopCells = 64;

std::int32_t cells_over(std::int32_t nodes, int log2) {
  return static_cast<std::int32_t>((std::int64_t{nodes} + (std::int64_t{1} << log2) - 1) >> log2);
}

/// Doubles the cell along its shortest side, as long as that joins any; false when it holds the whole volume.
bool double_cell(std::array<int, 3>& log2, GridShape shape, Vec3d steps) {
  int shortest = -1;
  double length = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    const double side = std::ldexp(steps[axis], log2[axis]);
    if (cells_over(shape[axis], log2[axis]) < 2 || side >= length) continue;
    shortest = axis;
    length = side;
  }
  if (shortest < 0) return false;
  ++log2[shortest];
  return true;
}

SamplePyramid::Level empty_level(std::array<int, 3> log2, GridShape shape) {
  SamplePyramid::Level level;
  level.log2 = log2;
  level.cells = {cells_over(shape.inlines, log2[0]), cells_over(shape.crosslines, log2[1]),
                 cells_over(shape.samples, log2[2])};
  level.cell.resize(static_cast<std::size_t>(level.cells.count()));
  return level;
}

/// Sums over samples, with positions counted from some origin close by.
struct Moments {
  double count = 0, sum = 0;
  Vec3d position, square, value_position;

  void add_row(const float* samples, std::int32_t count_k, Vec3d first, double step, double scale) {
    double n = 0, s = 0, z = 0, zz = 0, sz = 0;
    for (std::int32_t k = 0; k < count_k; ++k) {
      const bool is_valid = samples[k] == samples[k];
      const double one = is_valid ? 1 : 0, value = is_valid ? scale * static_cast<double>(samples[k]) : 0;
      const double at = first.z + step * k;
      n += one;
      s += value;
      z += one * at;
      zz += one * (at * at);
      sz += value * at;
    }
    count += n;
    sum += s;
    position = position + Vec3d{n * first.x, n * first.y, z};
    square = square + Vec3d{n * first.x * first.x, n * first.y * first.y, zz};
    value_position = value_position + Vec3d{s * first.x, s * first.y, sz};
  }

  /// The samples of a cell that begins `corner` from the origin.
  void add(const SampleCell& cell, Vec3d corner) {
    const double n = static_cast<double>(cell.count), s = static_cast<double>(cell.sum);
    const Vec3d at = to_double(cell.centre) + corner;
    count += n;
    sum += s;
    for (int axis = 0; axis < 3; ++axis) {
      position[axis] += n * at[axis];
      square[axis] += n * (static_cast<double>(cell.variance[axis]) + at[axis] * at[axis]);
      value_position[axis] += static_cast<double>(cell.moment[axis]) + s * at[axis];
    }
  }

  SampleCell cell() const {
    SampleCell result;
    if (count == 0) return result;
    result.count = static_cast<float>(count);
    result.sum = static_cast<float>(sum);
    for (int axis = 0; axis < 3; ++axis) {
      const double mean = position[axis] / count;
      result.centre[axis] = static_cast<float>(mean);
      result.variance[axis] = static_cast<float>(std::max(0.0, square[axis] / count - mean * mean));
      result.moment[axis] = static_cast<float>(value_position[axis] - mean * sum);
    }
    return result;
  }
};

Vec3d corner_of(GridIndex cell, const std::array<int, 3>& log2, Vec3d steps) {
  return {std::ldexp(steps.x * cell.i, log2[0]), std::ldexp(steps.y * cell.j, log2[1]),
          std::ldexp(steps.z * cell.k, log2[2])};
}

/// Fills the lowest level from the bricks, one strip of cells after the other.
class CellReader {
 public:
  CellReader(const BrickedVolume& volume, Vec3d steps, double scale, SamplePyramid::Level& level)
      : volume_(volume), steps_(steps), scale_(scale), level_(level) {
    strip_cells_ = std::max(1, kStripNodes >> level.log2[1]);
    strips_ = (level.cells.crosslines + strip_cells_ - 1) / strip_cells_;
  }

  std::optional<Error> read(int threads, Progress& progress) {
    const auto count = static_cast<std::size_t>(level_.cells.inlines) * static_cast<std::size_t>(strips_);
    parallel_for(count, threads, [&](std::size_t task) {
      if (progress.cancelled() || is_damaged_) return;
      const auto strip = static_cast<std::int32_t>(task % static_cast<std::size_t>(strips_));
      read_strip(static_cast<std::int32_t>(task / static_cast<std::size_t>(strips_)), strip * strip_cells_);
    });
    if (is_damaged_) return damage_;
    if (progress.cancelled()) return Error{ErrorCode::cancelled, "Reading the samples was cancelled"};
    return std::nullopt;
  }

 private:
  void read_strip(std::int32_t i, std::int32_t first_j) {
    const GridShape shape = volume_.shape();
    const auto last = [&](std::int32_t cell, int axis) {
      return std::min(((cell + 1) << level_.log2[axis]), shape[axis]) - 1;
    };
    const std::int32_t last_j = std::min(first_j + strip_cells_, level_.cells.crosslines) - 1;
    const GridBox box{{i << level_.log2[0], first_j << level_.log2[1], 0},
                      {last(i, 0), last(last_j, 1), shape.samples - 1}};
    const auto samples = read_box(volume_, box);
    if (!samples) {
      const std::lock_guard lock(mutex_);
      damage_ = samples.error();
      is_damaged_ = true;
      return;
    }
    for (std::int32_t j = first_j; j <= last_j; ++j)
      for (std::int32_t k = 0; k < level_.cells.samples; ++k) read_cell(*samples, {i, j, k});
  }

  void read_cell(const SampleBox& samples, GridIndex cell) {
    std::int32_t from[3], to[3];
    for (int axis = 0; axis < 3; ++axis) {
      from[axis] = (cell[axis] << level_.log2[axis]) - samples.first[axis];
      to[axis] = std::min(from[axis] + (1 << level_.log2[axis]), samples.shape[axis]);
    }
    Moments moments;
    for (std::int32_t a = from[0]; a < to[0]; ++a)
      for (std::int32_t b = from[1]; b < to[1]; ++b)
        moments.add_row(&samples.value[samples.at(a, b, from[2])], to[2] - from[2],
                        {steps_.x * (a - from[0]), steps_.y * (b - from[1]), 0}, steps_.z, scale_);
    const std::size_t at = (static_cast<std::size_t>(cell.i) * level_.cells.crosslines + cell.j) *
                               static_cast<std::size_t>(level_.cells.samples) +
                           static_cast<std::size_t>(cell.k);
    level_.cell[at] = moments.cell();
  }

  const BrickedVolume& volume_;
  Vec3d steps_;
  double scale_;
  SamplePyramid::Level& level_;
  std::int32_t strip_cells_ = 1, strips_ = 1;
  std::mutex mutex_;
  std::atomic<bool> is_damaged_ = false;
  Error damage_;
};

void join_cells(const SamplePyramid::Level& fine, Vec3d steps, SamplePyramid::Level& coarse) {
  std::size_t next = 0;
  for (std::int32_t i = 0; i < coarse.cells.inlines; ++i)
    for (std::int32_t j = 0; j < coarse.cells.crosslines; ++j)
      for (std::int32_t k = 0; k < coarse.cells.samples; ++k) {
        const GridIndex cell{i, j, k};
        const Vec3d corner = corner_of(cell, coarse.log2, steps);
        std::int32_t from[3], to[3];
        for (int axis = 0; axis < 3; ++axis) {
          const int more = coarse.log2[axis] - fine.log2[axis];
          from[axis] = cell[axis] << more;
          to[axis] = std::min(from[axis] + (1 << more), fine.cells[axis]);
        }
        Moments moments;
        for (std::int32_t a = from[0]; a < to[0]; ++a)
          for (std::int32_t b = from[1]; b < to[1]; ++b)
            for (std::int32_t c = from[2]; c < to[2]; ++c)
              moments.add(fine.row(a, b)[c], corner_of({a, b, c}, fine.log2, steps) - corner);
        coarse.cell[next++] = moments.cell();
      }
}

double scale_for(ValueRange range) {
  if (range.min > range.max) return 1;
  const double largest = std::max(std::abs(static_cast<double>(range.min)), std::abs(static_cast<double>(range.max)));
  int exponent = 0;
  std::frexp(largest, &exponent);
  return std::ldexp(1.0, -exponent);
}

}  // namespace

Vec3d SamplePyramid::corner(const Level& level, GridIndex cell) const {
  return corner_of(cell, level.log2, steps_);
}

Result<SamplePyramid> SamplePyramid::build(const BrickedVolume& volume, Vec3d step_lengths, int threads,
                                           Progress& progress) {
  SamplePyramid pyramid;
  const double shortest = std::min({step_lengths.x, step_lengths.y, step_lengths.z});
  pyramid.steps_ = {step_lengths.x / shortest, step_lengths.y / shortest, step_lengths.z / shortest};
  pyramid.range_ = value_range(volume);
  pyramid.scale_ = scale_for(pyramid.range_);

  const GridShape shape = volume.shape();
  std::array<int, 3> log2{};
  for (int n = 0; n < kCellNodesLog2 && double_cell(log2, shape, pyramid.steps_); ++n) {
  }
  pyramid.levels_.push_back(empty_level(log2, shape));
  CellReader reader(volume, pyramid.steps_, pyramid.scale_, pyramid.levels_[0]);
  if (auto error = reader.read(threads, progress)) return std::move(*error);
  while (pyramid.levels_.back().cells.count() > kTopCells) {
    for (int n = 0; n < 3 && double_cell(log2, shape, pyramid.steps_); ++n) {
    }
    Level next = empty_level(log2, shape);
    join_cells(pyramid.levels_.back(), pyramid.steps_, next);
    pyramid.levels_.push_back(std::move(next));
  }
  return pyramid;
}

}  // namespace geosis
