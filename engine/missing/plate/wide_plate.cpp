#include "engine/missing/plate/wide_plate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "engine/missing/plate/narrow_plate.h"
#include "engine/missing/plate/plate_rows.h"
#include "engine/missing/plate/poisson_cycle.h"

namespace geosis {
namespace {

constexpr int kMaxRounds = 6;
constexpr int kMaxIterations = 600;
constexpr double kRoundGain = 1e-4;  // float32 vectors hold no more
constexpr std::size_t kNodesBetweenAsking = 1 << 15;
constexpr int kMargin = 2;  // nodes that stencils reach beyond the gap

/// The sum over a and b's products, in eight lanes whose order is fixed.
double dot(const std::vector<float>& a, const std::vector<float>& b) {
  std::array<double, 8> lane{};
  const std::size_t whole = a.size() / 8 * 8;
  for (std::size_t x = 0; x < whole; x += 8)
    for (std::size_t l = 0; l < 8; ++l) lane[l] += static_cast<double>(a[x + l]) * static_cast<double>(b[x + l]);
  for (std::size_t x = whole; x < a.size(); ++x) lane[0] += static_cast<double>(a[x]) * static_cast<double>(b[x]);
  return ((lane[0] + lane[1]) + (lane[2] + lane[3])) + ((lane[4] + lane[5]) + (lane[6] + lane[7]));
}

/// The gap's bounding box with its margin, which may lie outside the gap box: nothing is available there.
struct PaddedBox {
  GridIndex first;  // in the gap box
  GridShape shape;

  std::size_t row() const { return static_cast<std::size_t>(shape.samples); }
  std::size_t plane() const { return row() * static_cast<std::size_t>(shape.crosslines); }
  std::size_t nodes() const { return static_cast<std::size_t>(shape.count()); }
};

GridIndex index_of(std::uint32_t place, GridShape shape) {
  const auto samples = static_cast<std::uint32_t>(shape.samples),
             crosslines = static_cast<std::uint32_t>(shape.crosslines);
  const std::uint32_t row = place / samples;
  return {static_cast<std::int32_t>(row / crosslines), static_cast<std::int32_t>(row % crosslines),
          static_cast<std::int32_t>(place % samples)};
}

PaddedBox padded_box(std::span<const PlateNode> nodes, GridShape shape) {
  GridIndex low = index_of(nodes[0].place, shape), high = low;
  for (const PlateNode& node : nodes) {
    const GridIndex at = index_of(node.place, shape);
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], at[axis]);
      high[axis] = std::max(high[axis], at[axis]);
    }
  }
  PaddedBox box;
  box.first = {low.i - kMargin, low.j - kMargin, low.k - kMargin};
  box.shape = {high.i - low.i + 1 + 2 * kMargin, high.j - low.j + 1 + 2 * kMargin, high.k - low.k + 1 + 2 * kMargin};
  return box;
}

class WidePlate {
 public:
  WidePlate(GapBox& gap, std::span<const PlateNode> nodes, Vec3d weights, const ThinPlateOptions& options,
            const Progress& progress)
      : gap_(gap),
        nodes_(nodes),
        weights_(weights),
        options_(options),
        progress_(progress),
        box_(padded_box(nodes, gap.samples.shape)),
        rows_(weights),
        strides_(plate_strides(static_cast<std::ptrdiff_t>(box_.plane()), static_cast<std::ptrdiff_t>(box_.row()))) {}

  WidePlateEffort fill() {
    load();
    WidePlateEffort effort;
    const double reference = find_residual(exact_residual());
    start_from_given();
    double size = find_residual(exact_residual());
    while (size > options_.tolerance * reference && effort.rounds < kMaxRounds && !progress_.cancelled()) {
      const double before = size;
      effort.iterations += iterate(std::max(options_.tolerance * reference / size, kRoundGain));
      ++effort.rounds;
      if (progress_.cancelled()) break;
      size = find_residual(exact_residual());
      if (!(size < before / 2)) break;
    }
    store();
    return effort;
  }

 private:
  /// The known samples less their mean; states as the Poisson problem takes them: what is not this gap's is fixed.
  void load() {
    std::vector<NodeState> state(box_.nodes(), NodeState::absent);
    solution_.resize(box_.nodes());
    copy_known(state);
    for (const PlateNode& node : nodes_) {
      const GridIndex at = index_of(node.place, gap_.samples.shape);
      const std::size_t place = (at.i - box_.first.i) * box_.plane() + (at.j - box_.first.j) * box_.row() +
                                static_cast<std::size_t>(at.k - box_.first.k);
      state[place] = NodeState::wanted;
      places_.push_back(static_cast<std::uint32_t>(place));
      if (node.available != kWholePlate)
        rim_.push_back({static_cast<std::uint32_t>(places_.size() - 1), rows_.number(node.available)});
    }
    for (auto* array : {&residual_, &direction_, &image_, &correction_, &spare_}) array->resize(box_.nodes());
    poisson_.emplace(box_.shape, std::move(state), weights_, progress_);
  }

  void copy_known(std::vector<NodeState>& state) {
    double sum = 0, count = 0;
    visit_rows([&](std::size_t from, std::size_t to, std::size_t length) {
      for (std::size_t k = 0; k < length; ++k) {
        if (gap_.state[from + k] != NodeState::absent) state[to + k] = NodeState::known;
        if (gap_.state[from + k] != NodeState::known) continue;
        sum += static_cast<double>(gap_.samples.value[from + k]);
        count += 1;
      }
    });
    mean_ = count == 0 ? 0 : sum / count;
    visit_rows([&](std::size_t from, std::size_t to, std::size_t length) {
      for (std::size_t k = 0; k < length; ++k)
        if (gap_.state[from + k] == NodeState::known)
          solution_[to + k] = static_cast<double>(gap_.samples.value[from + k]) - mean_;
    });
  }

  /// Calls visit(place in the gap box, place in the padded box, length) for the rows that both hold.
  template <class Visit>
  void visit_rows(const Visit& visit) const {
    const GridShape shape = gap_.samples.shape;
    GridIndex low, high;
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = std::max(box_.first[axis], 0);
      high[axis] = std::min(box_.first[axis] + box_.shape[axis], shape[axis]);
    }
    for (std::int32_t i = low.i; i < high.i; ++i)
      for (std::int32_t j = low.j; j < high.j; ++j)
        visit(gap_.samples.at(i, j, low.k),
              (i - box_.first.i) * box_.plane() + (j - box_.first.j) * box_.row() +
                  static_cast<std::size_t>(low.k - box_.first.k),
              static_cast<std::size_t>(high.k - low.k));
  }

  void start_from_given() {
    for (std::size_t n = 0; n < nodes_.size(); ++n)
      solution_[places_[n]] = static_cast<double>(gap_.samples.value[nodes_[n].place]) - mean_;
  }

  template <class T>
  double row_times(const PlateRow& row, const std::vector<T>& f, std::size_t place) const {
    double sum = 0;
    for (int m = 0; m < kPlateReach; ++m) sum += row[m] * static_cast<double>(f[place + strides_[m]]);
    return sum;
  }

  /// - A solution, in double, in the order of nodes_.
  std::vector<double> exact_residual() const {
    std::vector<double> residual(nodes_.size());
    for (std::size_t n = 0; n < nodes_.size(); ++n) {
      if (n % kNodesBetweenAsking == 0 && progress_.cancelled()) return residual;
      residual[n] = -row_times(rows_[0], solution_, places_[n]);
    }
    for (const RimNode& rim : rim_) residual[rim.node] = -row_times(rows_[rim.row], solution_, places_[rim.node]);
    return residual;
  }

  /// Takes the residual over, scaled by a power of two to at most 1, and returns its norm.
  double find_residual(const std::vector<double>& exact) {
    double largest = 0;
    for (const double value : exact) largest = std::max(largest, std::abs(value));
    int exponent = 0;
    std::frexp(largest, &exponent);
    scale_ = std::ldexp(1.0, exponent);
    double sum = 0;
    for (std::size_t n = 0; n < exact.size(); ++n) {
      const double scaled = exact[n] / scale_;
      residual_[places_[n]] = static_cast<float>(scaled);
      sum += scaled * scaled;
    }
    return std::sqrt(sum) * scale_;
  }

  /// image = A direction. Where every stencil is there, A is L L.
  void multiply() {
    apply_laplacian(direction_, spare_);
    apply_laplacian(spare_, image_);
    const auto inverse = poisson_->inverse_diagonal();
    for (std::size_t x = 0; x < image_.size(); ++x) image_[x] = inverse[x] > 0 ? image_[x] : 0;
    for (const RimNode& rim : rim_)
      image_[places_[rim.node]] = static_cast<float>(row_times(rows_[rim.row], direction_, places_[rim.node]));
  }

  void apply_laplacian(const std::vector<float>& from, std::vector<float>& to) const {
    const float a = static_cast<float>(weights_.x), b = static_cast<float>(weights_.y),
                c = static_cast<float>(weights_.z), middle = 2 * (a + b + c);
    const std::size_t plane = box_.plane(), row = box_.row(), begin = plane + row + 1, end = from.size() - begin;
    const float* f = from.data();
    float* result = to.data();
    for (std::size_t x = begin; x < end; ++x)
      result[x] =
          middle * f[x] - a * (f[x - plane] + f[x + plane]) - b * (f[x - row] + f[x + row]) - c * (f[x - 1] + f[x + 1]);
  }

  /// correction = the inverse of L L, nearly, times residual.
  void precondition() {
    poisson_->solve(residual_, image_, spare_);
    poisson_->solve(image_, correction_, spare_);
  }

  /// One round of conjugate gradients until the residual has shrunk to `share` of what it is now.
  int iterate(double share) {
    const double enough = share * share * dot(residual_, residual_);
    int iterations = 0;
    double agreement = 0;
    while (iterations < kMaxIterations) {
      precondition();
      if (progress_.cancelled()) break;
      const double next = dot(residual_, correction_);
      const auto keep = static_cast<float>(iterations == 0 ? 0 : next / agreement);
      agreement = next;
      for (std::size_t x = 0; x < direction_.size(); ++x) direction_[x] = correction_[x] + keep * direction_[x];
      multiply();
      const double bending = dot(direction_, image_);
      if (!(bending > 0) || !(agreement > 0)) break;
      step(agreement / bending);
      ++iterations;
      if (dot(residual_, residual_) <= enough) break;
    }
    return iterations;
  }

  void step(double length) {
    const double scaled = length * scale_;
    const auto back = static_cast<float>(length);
    for (std::size_t x = 0; x < direction_.size(); ++x) {
      solution_[x] += scaled * static_cast<double>(direction_[x]);
      residual_[x] -= back * image_[x];
    }
  }

  void store() {
    for (std::size_t n = 0; n < nodes_.size(); ++n)
      gap_.samples.value[nodes_[n].place] = clamped(solution_[places_[n]] + mean_, options_);
  }

  /// A node of the gap that lacks stencils.
  struct RimNode {
    std::uint32_t node, row;
  };

  GapBox& gap_;
  std::span<const PlateNode> nodes_;
  Vec3d weights_;
  const ThinPlateOptions& options_;
  const Progress& progress_;
  PaddedBox box_;
  PlateRows rows_;
  std::array<std::ptrdiff_t, kPlateReach> strides_;
  std::vector<std::uint32_t> places_;  // of nodes_, in the padded box
  std::vector<RimNode> rim_;
  std::optional<PoissonCycle> poisson_;
  double mean_ = 0, scale_ = 1;
  // Over the padded box. All but the solution, which also holds the known samples, are zero outside the gap.
  std::vector<double> solution_;
  std::vector<float> residual_, direction_, image_, correction_, spare_;
};

}  // namespace

WidePlateEffort fill_wide_plate(GapBox& gap, std::span<const PlateNode> nodes, Vec3d weights,
                                const ThinPlateOptions& options, const Progress& progress) {
  return WidePlate(gap, nodes, weights, options, progress).fill();
}

}  // namespace geosis
