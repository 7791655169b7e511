#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/base/progress.h"
#include "engine/missing/gaps/gap_box.h"
#include "engine/missing/plate/plate_gaps.h"
#include "engine/missing/plate/plate_rows.h"
#include "engine/missing/plate/thin_plate.h"

namespace geosis {

/// A value as it is stored: finite and in the options' range.
float clamped(double value, const ThinPlateOptions& options);

/// Solves gaps that are only a few nodes across: conjugate gradients with the diagonal over the gap's nodes, in double
/// precision. The number of iterations grows with the square of the gap's width. Scattered gaps take c_a = 1.
class NarrowPlate {
 public:
  static constexpr int kMaxIterations = 2000;

  /// gaps  of gap; both outlive this object.
  NarrowPlate(GapBox& gap, const PlateGaps& gaps, Vec3d weights, const ThinPlateOptions& options,
              const Progress& progress);

  /// Fills one of the gaps; returns the iterations that it took.
  ///
  /// cost  about 0.4 us per node, plus 20 ns per node and iteration; memory: 5 bytes per pair of joined nodes, 60 per
  ///       node.
  int solve(const PlateGap& which);

 private:
  void assemble(std::span<const PlateNode> nodes, const PlateGap& which);
  double mean_around(std::span<const PlateNode> nodes) const;
  void add_row(const PlateNode& node, const PlateGap& which);
  void multiply(const std::vector<double>& x, std::vector<double>& y) const;
  int iterate(double enough);

  GapBox& gap_;
  const PlateGaps& gaps_;
  const ThinPlateOptions& options_;
  const Progress& progress_;
  PlateRows rows_of_traces_, rows_of_points_;
  PlateRows* rows_ = nullptr;  // of the gap at hand
  std::array<std::ptrdiff_t, kPlateReach> strides_;
  std::vector<std::uint32_t> number_;  // (nodes of the box): place -> number in gaps.nodes

  // The gap's equations: row n has links [first_link_[n], first_link_[n + 1]) besides its diagonal.
  std::vector<std::uint32_t> row_number_, first_link_, link_;
  std::vector<std::uint8_t> link_offset_;
  double mean_ = 0;
  std::vector<double> inverse_diagonal_, right_, x_, residual_, direction_, image_;
};

}  // namespace geosis
