#include "engine/missing/plate/narrow_plate.h"

namespace geosis {
namespace {

constexpr std::size_t kRowsBetweenAsking = 1 << 15;

}  // namespace

float clamped(double value, const ThinPlateOptions& options) {
  // Written so that NaN becomes low.
  if (!(value >= static_cast<double>(options.low))) return options.low;
  if (!(value <= static_cast<double>(options.high))) return options.high;
  return static_cast<float>(value);
}

NarrowPlate::NarrowPlate(GapBox& gap, const PlateGaps& gaps, Vec3d weights, const ThinPlateOptions& options,
                         const Progress& progress)
    : gap_(gap),
      gaps_(gaps),
      options_(options),
      progress_(progress),
      rows_of_traces_(weights),
      rows_of_points_({1, 1, 1}),
      strides_(PlateNeighbours(gap).strides()),
      number_(gap.state.size()) {
  for (std::size_t n = 0; n < gaps.nodes.size(); ++n) number_[gaps.nodes[n].place] = static_cast<std::uint32_t>(n);
}

/// Mean of the known samples that share a stencil with the gap, as often as they do. Taken off, the equations no longer
/// know how far from zero the amplitudes are.
double NarrowPlate::mean_around(std::span<const PlateNode> nodes) const {
  double sum = 0, count = 0;
  for (const PlateNode& node : nodes) {
    for (int m = 1; m < kPlateReach; ++m) {
      if (((node.available >> m) & 1) == 0) continue;
      const std::size_t place = node.place + strides_[m];
      if (gap_.state[place] != NodeState::known) continue;
      sum += static_cast<double>(gap_.samples.value[place]);
      count += 1;
    }
  }
  return count == 0 ? 0 : sum / count;
}

void NarrowPlate::add_row(const PlateNode& node, const PlateGap& which) {
  const std::uint32_t number = rows_->number(node.available);
  const PlateRow& row = (*rows_)[number];
  double right = 0;
  for (int m = 1; m < kPlateReach; ++m) {
    if (row[m] == 0) continue;
    const std::size_t place = node.place + strides_[m];
    if (gap_.state[place] == NodeState::known) {
      right -= row[m] * (static_cast<double>(gap_.samples.value[place]) - mean_);
    } else {
      link_.push_back(number_[place] - which.first);
      link_offset_.push_back(static_cast<std::uint8_t>(m));
    }
  }
  row_number_.push_back(number);
  first_link_.push_back(static_cast<std::uint32_t>(link_.size()));
  right_.push_back(right);
  // A node that no stencil holds keeps its value.
  inverse_diagonal_.push_back(row[0] > 0 ? 1 / row[0] : 0);
  x_.push_back(static_cast<double>(gap_.samples.value[node.place]) - mean_);
}

void NarrowPlate::multiply(const std::vector<double>& x, std::vector<double>& y) const {
  for (std::size_t n = 0; n < x.size(); ++n) {
    const PlateRow& row = (*rows_)[row_number_[n]];
    double sum = row[0] * x[n];
    for (std::uint32_t l = first_link_[n]; l < first_link_[n + 1]; ++l) sum += row[link_offset_[l]] * x[link_[l]];
    y[n] = sum;
  }
}

/// Conjugate gradients until residual^T D^-1 residual <= enough.
int NarrowPlate::iterate(double enough) {
  const std::size_t count = x_.size();
  multiply(x_, image_);
  double size = 0;
  for (std::size_t n = 0; n < count; ++n) {
    residual_[n] = right_[n] - image_[n];
    direction_[n] = inverse_diagonal_[n] * residual_[n];
    size += direction_[n] * residual_[n];
  }
  int iterations = 0;
  while (size > enough && iterations < kMaxIterations && !progress_.cancelled()) {
    multiply(direction_, image_);
    double bending = 0;
    for (std::size_t n = 0; n < count; ++n) bending += direction_[n] * image_[n];
    if (!(bending > 0)) break;
    const double step = size / bending;
    double next_size = 0;
    for (std::size_t n = 0; n < count; ++n) {
      x_[n] += step * direction_[n];
      residual_[n] -= step * image_[n];
      next_size += inverse_diagonal_[n] * residual_[n] * residual_[n];
    }
    const double keep = next_size / size;
    size = next_size;
    for (std::size_t n = 0; n < count; ++n) direction_[n] = inverse_diagonal_[n] * residual_[n] + keep * direction_[n];
    ++iterations;
  }
  return iterations;
}

void NarrowPlate::assemble(std::span<const PlateNode> nodes, const PlateGap& which) {
  row_number_.clear();
  first_link_.assign(1, 0);
  link_.clear();
  link_offset_.clear();
  right_.clear();
  inverse_diagonal_.clear();
  x_.clear();
  rows_ = which.scattered ? &rows_of_points_ : &rows_of_traces_;
  mean_ = mean_around(nodes);
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    if (n % kRowsBetweenAsking == kRowsBetweenAsking - 1 && progress_.cancelled()) return;
    add_row(nodes[n], which);
  }
  for (std::vector<double>* vector : {&residual_, &direction_, &image_}) vector->resize(nodes.size());
}

int NarrowPlate::solve(const PlateGap& which) {
  const auto nodes = std::span(gaps_.nodes).subspan(which.first, which.last - which.first);
  assemble(nodes, which);
  if (x_.size() < nodes.size()) return 0;
  double reference = 0;
  for (std::size_t n = 0; n < nodes.size(); ++n) reference += right_[n] * right_[n] * inverse_diagonal_[n];
  const int iterations = iterate(options_.tolerance * options_.tolerance * reference);
  for (std::size_t n = 0; n < nodes.size(); ++n) gap_.samples.value[nodes[n].place] = clamped(x_[n] + mean_, options_);
  return iterations;
}

}  // namespace geosis
