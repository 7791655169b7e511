#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "engine/volume/formats/import.h"
#include "engine/volume/formats/trace_grid.h"

namespace geosis {

/// x and y as affine functions of the grid position: origin + i * step_i + j * step_j; z is 0 in all three.
struct PlaneMap {
  Vec3d origin, step_i, step_j;
  double rms = 0;  ///< root mean square distance of the traces from it
};

/// Least squares over traces that come one by one, with sums relative to the first: the same result for the same order.
class PlaneFit {
 public:
  void add(double i, double j, double x, double y);
  std::int64_t count() const { return count_; }
  /// std::nullopt when the traces do not span both directions.
  std::optional<PlaneMap> solve() const;

 private:
  struct Sums {
    double value = 0, times_i = 0, times_j = 0, squared = 0;
    void add(double i, double j, double v);
  };
  Vec3d slope(const Sums& sums) const;  // per i, per j, mean

  std::int64_t count_ = 0;
  double i0_ = 0, j0_ = 0, x0_ = 0, y0_ = 0;
  double i_ = 0, j_ = 0, ii_ = 0, ij_ = 0, jj_ = 0;
  Sums x_, y_;
};

/// The world coordinates of one pair of header words, and whether they are usable.
class CoordinateWords {
 public:
  /// scalar: in place of the one in byte 71, with the same meaning: positive multiplies, negative divides.
  CoordinateWords(HeaderWord x, HeaderWord y, std::optional<double> scalar) : x_(x), y_(y), scalar_(scalar) {}

  /// One trace of the grid at i * crosslines + j.
  void add(const HeaderView& header, const TraceGrid& grid, std::int64_t position);

  HeaderWord x() const { return x_; }
  HeaderWord y() const { return y_; }
  /// errors: unsupported, with the reason why these words are no coordinates of this grid.
  Result<PlaneMap> solve() const;

 private:
  HeaderWord x_, y_;
  std::optional<double> scalar_;
  PlaneFit fit_;
  bool are_survey_numbers_ = true;
  bool geographic_ = false;
};

}  // namespace geosis
