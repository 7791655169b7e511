#include "engine/missing/inverse_distance/inverse_distance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "engine/volume/sample_box.h"

namespace geosis {
namespace {

using Level = SamplePyramid::Level;

constexpr std::size_t kRowLanes = 4;    // rows of near samples are a multiple of this
constexpr std::size_t kCellLanes = 32;  // far cells that are summed side by side
constexpr std::int32_t kTileNodes = 96;
constexpr std::int32_t kReach = 1;  // cells round one's own that are not taken as a whole

/// sum(f_n w_n) and sum(w_n).
struct Sums {
  double values = 0, weights = 0;
};

/// Every lane is a sum of its own, so that the compiler may turn the loops over lanes into vector instructions without
/// changing the order of any sum.
double total(const float* lanes, std::size_t count) {
  double sum = 0;
  for (std::size_t l = 0; l < count; ++l) sum += static_cast<double>(lanes[l]);
  return sum;
}

/// The samples of the 3^3 cells round one, as rows along the sample axis whose length is a multiple of the lanes.
class NearSamples {
 public:
  /// box holds the samples of `nodes`; steps and scale as the pyramid's.
  void load(const SampleBox& box, const GridBox& nodes, Vec3d steps, double scale) {
    first_ = nodes.first;
    steps_ = {static_cast<float>(steps.x), static_cast<float>(steps.y), static_cast<float>(steps.z)};
    const auto count = static_cast<std::size_t>(nodes.last.k - nodes.first.k) + 1;
    length_ = (count + kRowLanes - 1) / kRowLanes * kRowLanes;
    const auto rows = static_cast<std::size_t>(nodes.last.i - nodes.first.i + 1) *
                      static_cast<std::size_t>(nodes.last.j - nodes.first.j + 1);
    rows_.clear();
    if (value_.size() < rows * length_) {
      value_.resize(rows * length_);
      valid_.resize(rows * length_);
    }
    for (std::int32_t i = nodes.first.i; i <= nodes.last.i; ++i)
      for (std::int32_t j = nodes.first.j; j <= nodes.last.j; ++j)
        load_row(&box.value[box.at(i - box.first.i, j - box.first.j, nodes.first.k - box.first.k)], count, {i, j, 0},
                 scale);
  }

  Sums sums_at(GridIndex node) {
    along_.resize(length_);
    for (std::size_t k = 0; k < length_; ++k) {
      const float distance = steps_.z * static_cast<float>(first_.k + static_cast<std::int32_t>(k) - node.k);
      along_[k] = distance * distance;
    }
    values_.assign(length_, 0);
    weights_.assign(length_, 0);
    for (std::size_t r = 0; r < rows_.size(); ++r) {
      const float a = steps_.x * static_cast<float>(rows_[r].i - node.i);
      const float b = steps_.y * static_cast<float>(rows_[r].j - node.j);
      add_row(a * a + b * b, &value_[r * length_], &valid_[r * length_]);
    }
    return {total(values_.data(), length_), total(weights_.data(), length_)};
  }

 private:
  void load_row(const float* samples, std::size_t count, GridIndex row, double scale) {
    float* __restrict value = value_.data() + rows_.size() * length_;
    float* __restrict valid = valid_.data() + rows_.size() * length_;
    for (std::size_t k = 0; k < count; ++k) {
      const bool is_valid = samples[k] == samples[k];
      valid[k] = is_valid ? 1.0f : 0.0f;
      value[k] = static_cast<float>(is_valid ? scale * static_cast<double>(samples[k]) : 0);
    }
    for (std::size_t k = count; k < length_; ++k) value[k] = valid[k] = 0;
    if (std::find(valid, valid + length_, 1.0f) != valid + length_) rows_.push_back(row);
  }

  void add_row(float across, const float* value, const float* valid) {
    const float* __restrict along = along_.data();
    float* __restrict values = values_.data();
    float* __restrict weights = weights_.data();
    for (std::size_t k = 0; k < length_; ++k) {
      // No other node is closer than 1: the bound only keeps the node's own place, which is missing, from 0 / 0.
      const float square = std::max(across + along[k], 1.0f);
      const float weight = valid[k] / (square * square * square);
      weights[k] += weight;
      values[k] += weight * value[k];
    }
  }

  GridIndex first_;
  Vec3f steps_;
  std::size_t length_ = 0;
  std::vector<GridIndex> rows_;  // those with a valid sample
  std::vector<float> value_, valid_;
  // Of the node that is being summed, per place in the rows: squared distance along them, sums over all of them.
  std::vector<float> along_, values_, weights_;
};

/// Cells of one level that are taken as a whole.
class FarCells {
 public:
  /// size  of a cell, its longest side.  most  cells that will be added.
  void start(double size, std::size_t most) {
    size_ = size;
    used_ = 0;
    const std::size_t room = (most + kCellLanes - 1) / kCellLanes * kCellLanes;
    for (auto& column : column_)
      if (column.size() < room) column.resize(room);
  }
  /// corner  of the cell, from the same origin as the nodes' positions.
  void add(const SampleCell& cell, Vec3f corner) {
    const std::array<float, kColumns> fields = {cell.count,
                                                cell.sum,
                                                corner.x + cell.centre.x,
                                                corner.y + cell.centre.y,
                                                corner.z + cell.centre.z,
                                                cell.variance.x,
                                                cell.variance.y,
                                                cell.variance.z,
                                                cell.moment.x,
                                                cell.moment.y,
                                                cell.moment.z};
    for (std::size_t c = 0; c < kColumns; ++c) column_[c][used_] = fields[c];
    ++used_;
  }
  /// Fills the last lanes with cells that weigh nothing.
  void finish() {
    while (used_ % kCellLanes != 0) add({}, {static_cast<float>(2 * size_), 0, 0});
  }

  /// The kernel's Taylor series round each cell's centre: to second order for the positions, first for the values.
  Sums sums_at(Vec3d position) const {
    const auto unit =
        static_cast<float>(size_ * size_);  // weights in this level's own unit neither over- nor underflow
    const auto px = static_cast<float>(position.x), py = static_cast<float>(position.y),
               pz = static_cast<float>(position.z);
    std::array<float, kCellLanes> values{}, weights{};
    for (std::size_t n = 0; n < used_; n += kCellLanes) add_cells(n, {px, py, pz}, unit, values, weights);
    const double back = 1 / (size_ * size_ * size_ * size_ * size_ * size_);
    return {total(values.data(), kCellLanes) * back, total(weights.data(), kCellLanes) * back};
  }

 private:
  static constexpr std::size_t kColumns = 11;
  using Sum = std::array<float, kCellLanes>;

  void add_cells(std::size_t first, Vec3f at, float unit, Sum& values, Sum& weights) const {
    std::array<const float*, kColumns> column;
    for (std::size_t c = 0; c < kColumns; ++c) column[c] = column_[c].data() + first;
    const auto& [count, sum, x, y, z, vx, vy, vz, mx, my, mz] = column;
    float* __restrict to_values = values.data();
    float* __restrict to_weights = weights.data();
    for (std::size_t l = 0; l < kCellLanes; ++l) {
      const float dx = x[l] - at.x, dy = y[l] - at.y, dz = z[l] - at.z;
      const float inverse = 1 / (dx * dx + dy * dy + dz * dz);
      const float share = unit * inverse, kernel = share * share * share;
      const float across = vx[l] * dx * dx + vy[l] * dy * dy + vz[l] * dz * dz;
      const float spread = 1 + inverse * (24 * inverse * across - 3 * (vx[l] + vy[l] + vz[l]));
      const float lean = mx[l] * dx + my[l] * dy + mz[l] * dz;
      to_weights[l] += kernel * (count[l] * spread);
      to_values[l] += kernel * (sum[l] * spread - 6 * inverse * lean);
    }
  }

  double size_ = 1;
  std::size_t used_ = 0;
  std::array<std::vector<float>, kColumns> column_;
};

GridIndex cell_of(GridIndex node, const Level& level) {
  return {node.i >> level.log2[0], node.j >> level.log2[1], node.k >> level.log2[2]};
}

/// A cell and those round it, as far as they exist.
GridBox around(GridIndex cell, GridShape cells) {
  GridBox box;
  for (int axis = 0; axis < 3; ++axis) {
    box.first[axis] = std::max(cell[axis] - kReach, 0);
    box.last[axis] = std::min(cell[axis] + kReach, cells[axis] - 1);
  }
  return box;
}

/// Nodes, or cells of a finer level, that cells hold.
GridBox inside_of(const GridBox& cells, const std::array<int, 3>& log2, GridShape finer) {
  GridBox box;
  for (int axis = 0; axis < 3; ++axis) {
    box.first[axis] = cells.first[axis] << log2[axis];
    box.last[axis] = std::min((cells.last[axis] + 1) << log2[axis], finer[axis]) - 1;
  }
  return box;
}

std::int64_t nodes_of(const GridBox& box) {
  return std::int64_t{box.last.i - box.first.i + 1} * (box.last.j - box.first.j + 1) * (box.last.k - box.first.k + 1);
}

bool holds(const GridBox& box, GridIndex at) {
  for (int axis = 0; axis < 3; ++axis)
    if (at[axis] < box.first[axis] || at[axis] > box.last[axis]) return false;
  return true;
}

class BoxFiller {
 public:
  BoxFiller(const BrickedVolume& volume, const SamplePyramid& pyramid, GapBox& gap, const Progress& progress)
      : volume_(volume), pyramid_(pyramid), lowest_(pyramid.levels()[0]), gap_(gap), progress_(progress) {
    far_.resize(pyramid.levels().size());
  }

  Result<void> fill() {
    const GridIndex first = gap_.samples.first;
    const GridShape shape = gap_.samples.shape;
    const GridIndex last{first.i + shape.inlines - 1, first.j + shape.crosslines - 1, first.k + shape.samples - 1};
    const GridBox cells{cell_of(first, lowest_), cell_of(last, lowest_)};
    GridIndex step;
    for (int axis = 0; axis < 3; ++axis) step[axis] = std::max(1, kTileNodes >> lowest_.log2[axis]);
    for (std::int32_t i = cells.first.i; i <= cells.last.i; i += step.i)
      for (std::int32_t j = cells.first.j; j <= cells.last.j; j += step.j)
        for (std::int32_t k = cells.first.k; k <= cells.last.k; k += step.k) {
          const GridBox tile{{i, j, k},
                             {std::min(i + step.i - 1, cells.last.i), std::min(j + step.j - 1, cells.last.j),
                              std::min(k + step.k - 1, cells.last.k)}};
          if (auto done = fill_tile(tile); !done) return done;
        }
    return {};
  }

 private:
  Result<void> fill_tile(const GridBox& cells) {
    std::optional<SampleBox> samples;  // read when a cell has a wanted node
    for (std::int32_t i = cells.first.i; i <= cells.last.i; ++i)
      for (std::int32_t j = cells.first.j; j <= cells.last.j; ++j)
        for (std::int32_t k = cells.first.k; k <= cells.last.k; ++k) {
          const GridIndex cell{i, j, k};
          list_wanted(cell);
          if (wanted_.empty()) continue;
          if (progress_.cancelled()) return Error{ErrorCode::cancelled, "Filling by inverse distance was cancelled"};
          if (!samples) {
            auto read = read_box(volume_, nodes_round(cells));
            if (!read) return std::move(read).error();
            samples = *std::move(read);
          }
          fill_cell(cell, *samples);
        }
    return {};
  }

  /// The nodes of some cells and of those next to them.
  GridBox nodes_round(const GridBox& cells) const {
    const GridBox low = around(cells.first, lowest_.cells), high = around(cells.last, lowest_.cells);
    return inside_of({low.first, high.last}, lowest_.log2, volume_.shape());
  }

  void list_wanted(GridIndex cell) {
    wanted_.clear();
    const GridBox nodes = inside_of({cell, cell}, lowest_.log2, volume_.shape());
    GridIndex from, to;  // in the gap box
    for (int axis = 0; axis < 3; ++axis) {
      from[axis] = std::max(nodes.first[axis] - gap_.samples.first[axis], 0);
      to[axis] = std::min(nodes.last[axis] - gap_.samples.first[axis] + 1, gap_.samples.shape[axis]);
    }
    for (std::int32_t a = from.i; a < to.i; ++a)
      for (std::int32_t b = from.j; b < to.j; ++b)
        for (std::int32_t c = from.k; c < to.k; ++c)
          if (gap_.state[gap_.samples.at(a, b, c)] == NodeState::wanted) wanted_.push_back({a, b, c});
  }

  void fill_cell(GridIndex cell, const SampleBox& samples) {
    near_.load(samples, nodes_round({cell, cell}), pyramid_.steps(), pyramid_.scale());
    for (std::size_t n = 0; n < far_.size(); ++n) gather(cell, n);
    for (const GridIndex at : wanted_) {
      const GridIndex first = gap_.samples.first;
      const GridIndex node{first.i + at.i, first.j + at.j, first.k + at.k};
      fill_node(cell, node, gap_.samples.value[gap_.samples.at(at.i, at.j, at.k)]);
    }
  }

  void fill_node(GridIndex cell, GridIndex node, float& value) {
    Sums sums = near_.sums_at(node);
    const Vec3d steps = pyramid_.steps();
    const Vec3d position = Vec3d{steps.x * node.i, steps.y * node.j, steps.z * node.k} - pyramid_.corner(lowest_, cell);
    for (const FarCells& far : far_) {
      const Sums more = far.sums_at(position);
      sums.values += more.values;
      sums.weights += more.weights;
    }
    if (!(sums.weights > 0)) return;
    const double filled = sums.values / sums.weights / pyramid_.scale();
    const ValueRange range = pyramid_.range();
    value = static_cast<float>(std::clamp(filled, static_cast<double>(range.min), static_cast<double>(range.max)));
  }

  /// Of a level, the cells that are too close for the level above but not next to the node's own.
  void gather(GridIndex lowest_cell, std::size_t number) {
    const auto& levels = pyramid_.levels();
    const Level& level = levels[number];
    const GridBox node = inside_of({lowest_cell, lowest_cell}, lowest_.log2, volume_.shape());
    const GridBox close = around(cell_of(node.first, level), level.cells);
    GridBox all{{0, 0, 0}, {level.cells.inlines - 1, level.cells.crosslines - 1, level.cells.samples - 1}};
    if (number + 1 < levels.size()) {
      const Level& above = levels[number + 1];
      std::array<int, 3> more;
      for (int axis = 0; axis < 3; ++axis) more[axis] = above.log2[axis] - level.log2[axis];
      all = inside_of(around(cell_of(node.first, above), above.cells), more, level.cells);
    }
    const Vec3d origin = pyramid_.corner(lowest_, lowest_cell), size = pyramid_.corner(level, {1, 1, 1});
    FarCells& far = far_[number];
    far.start(std::max({size.x, size.y, size.z}), static_cast<std::size_t>(nodes_of(all)));
    for (std::int32_t i = all.first.i; i <= all.last.i; ++i)
      for (std::int32_t j = all.first.j; j <= all.last.j; ++j) {
        const SampleCell* row = level.row(i, j);
        const auto x = static_cast<float>(size.x * i - origin.x), y = static_cast<float>(size.y * j - origin.y);
        for (std::int32_t k = all.first.k; k <= all.last.k; ++k)
          if (row[k].count > 0 && !holds(close, {i, j, k}))
            far.add(row[k], {x, y, static_cast<float>(size.z * k - origin.z)});
      }
    far.finish();
  }

  const BrickedVolume& volume_;
  const SamplePyramid& pyramid_;
  const Level& lowest_;
  GapBox& gap_;
  const Progress& progress_;
  std::vector<GridIndex> wanted_;  // of the cell, in the gap box
  NearSamples near_;
  std::vector<FarCells> far_;  // one per level
};

}  // namespace

InverseDistanceFill::InverseDistanceFill(const BrickedVolume& volume, SamplePyramid pyramid)
    : volume_(&volume), pyramid_(std::move(pyramid)) {}

Result<InverseDistanceFill> InverseDistanceFill::build(const BrickedVolume& volume, Vec3d step_lengths, int threads,
                                                       Progress& progress) {
  auto pyramid = SamplePyramid::build(volume, step_lengths, threads, progress);
  if (!pyramid) return std::move(pyramid).error();
  return InverseDistanceFill(volume, *std::move(pyramid));
}

Result<void> InverseDistanceFill::fill(GapBox& gap, const Progress& progress) const {
  return BoxFiller(*volume_, pyramid_, gap, progress).fill();
}

}  // namespace geosis
