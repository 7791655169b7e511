#include "engine/volume/formats/coordinate_fit.h"

#include <algorithm>
#include <cmath>

namespace geosis {
namespace {

/// Traces may lie this far from the fitted lattice, root mean square, in bins.
constexpr double kLargestMisfit = 0.5;

// The standard's convention: positive multiplies, negative divides, 0 is not filled in.
double factor_of(double scalar) {
  if (scalar == 0) return 1;
  return scalar > 0 ? scalar : -1 / scalar;
}

// Seconds of arc, degrees: not lengths.
bool has_geographic_units(const HeaderView& header) {
  const auto units = header.at<std::int16_t>(89);
  return units >= 2 && units <= 4;
}

}  // namespace

void PlaneFit::Sums::add(double i, double j, double v) {
  value += v;
  times_i += v * i;
  times_j += v * j;
  squared += v * v;
}

void PlaneFit::add(double i, double j, double x, double y) {
  if (count_++ == 0) {
    i0_ = i, j0_ = j, x0_ = x, y0_ = y;
  }
  i -= i0_, j -= j0_;
  i_ += i, j_ += j;
  ii_ += i * i, ij_ += i * j, jj_ += j * j;
  x_.add(i, j, x - x0_);
  y_.add(i, j, y - y0_);
}

// Normal equations about the means: the 2 x 2 system of the two slopes, then the value at the first trace.
Vec3d PlaneFit::slope(const Sums& sums) const {
  const auto n = static_cast<double>(count_);
  const double ii = ii_ - i_ * i_ / n, ij = ij_ - i_ * j_ / n, jj = jj_ - j_ * j_ / n;
  const double vi = sums.times_i - sums.value * i_ / n, vj = sums.times_j - sums.value * j_ / n;
  const double determinant = ii * jj - ij * ij;
  const double per_i = (vi * jj - vj * ij) / determinant, per_j = (vj * ii - vi * ij) / determinant;
  return {per_i, per_j, (sums.value - per_i * i_ - per_j * j_) / n};
}

std::optional<PlaneMap> PlaneFit::solve() const {
  if (count_ < 3) return std::nullopt;
  const auto n = static_cast<double>(count_);
  const double ii = ii_ - i_ * i_ / n, ij = ij_ - i_ * j_ / n, jj = jj_ - j_ * j_ / n;
  if (!(ii * jj - ij * ij > 1e-9 * ii * jj)) return std::nullopt;

  const Vec3d x = slope(x_), y = slope(y_);
  PlaneMap map;
  map.step_i = {x.x, y.x, 0};
  map.step_j = {x.y, y.y, 0};
  map.origin = {x0_ + x.z - x.x * i0_ - x.y * j0_, y0_ + y.z - y.x * i0_ - y.y * j0_, 0};
  const auto misfit = [](const Sums& sums, const Vec3d& fit) {
    return sums.squared - fit.x * sums.times_i - fit.y * sums.times_j - fit.z * sums.value;
  };
  map.rms = std::sqrt(std::max(0.0, misfit(x_, x) + misfit(y_, y)) / n);
  return map;
}

void CoordinateWords::add(const HeaderView& header, const TraceGrid& grid, std::int64_t position) {
  const std::int64_t x = x_.in(header), y = y_.in(header);
  if (x == 0 && y == 0) return;  // not filled in
  const std::int64_t inline_number = grid.inlines.word.in(header), crossline_number = grid.crosslines.word.in(header);
  are_survey_numbers_ = are_survey_numbers_ && ((x == inline_number && y == crossline_number) ||
                                                (x == crossline_number && y == inline_number));
  geographic_ = geographic_ || has_geographic_units(header);
  const double scalar = factor_of(scalar_.value_or(header.at<std::int16_t>(71)));
  const auto i = static_cast<double>(position / grid.crosslines.count);
  const auto j = static_cast<double>(position % grid.crosslines.count);
  fit_.add(i, j, static_cast<double>(x) * scalar, static_cast<double>(y) * scalar);
}

Result<PlaneMap> CoordinateWords::solve() const {
  const std::string where = "bytes " + std::to_string(x_.byte) + " and " + std::to_string(y_.byte);
  const auto useless = [&](const std::string& why) { return Error{ErrorCode::unsupported, where + " " + why}; };
  if (fit_.count() == 0) return useless("are zero");
  if (are_survey_numbers_) return useless("hold the survey numbers");
  if (geographic_) return useless("are geographic (coordinate units at byte 89)");
  const auto map = fit_.solve();
  if (!map) return useless("do not span the survey");
  const double i = norm(map->step_i), j = norm(map->step_j);
  const double area = std::fabs(map->step_i.x * map->step_j.y - map->step_i.y * map->step_j.x);
  if (!std::isfinite(area) || !(area > 1e-6 * i * j)) return useless("do not span the survey");
  if (map->rms > kLargestMisfit * std::min(i, j))
    return useless("lie " + std::to_string(map->rms) +
                   " (root mean square) off the lattice that fits best, with bins of " + std::to_string(i) + " x " +
                   std::to_string(j));
  return *map;
}

}  // namespace geosis
