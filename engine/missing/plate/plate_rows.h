#pragma once

#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "engine/base/vec3.h"
#include "engine/missing/gaps/gap_box.h"

namespace geosis {

/// The nodes that share a stencil of the bending energy with a node: itself (number 0), one and two steps away on each
/// axis, and the diagonals of the three planes. Sets of them are bit masks.
inline constexpr int kPlateReach = 25;
inline constexpr std::uint32_t kWholePlate = (1u << kPlateReach) - 1;
struct PlateOffset {
  std::int8_t i, j, k;
};
extern const std::array<PlateOffset, kPlateReach> kPlateOffsets;

/// Offsets in a dense array with these strides (that of the sample axis is 1).
std::array<std::ptrdiff_t, kPlateReach> plate_strides(std::ptrdiff_t plane, std::ptrdiff_t row);

/// What lies round a node of a box.
struct PlateSurroundings {
  std::uint32_t available = 0;  ///< in the box and not absent
  std::uint32_t wanted = 0;
};

/// Reads the states round nodes of a box.
class PlateNeighbours {
 public:
  explicit PlateNeighbours(const GapBox& gap);

  PlateSurroundings at(std::int32_t i, std::int32_t j, std::int32_t k) const;
  const std::array<std::ptrdiff_t, kPlateReach>& strides() const { return strides_; }

 private:
  const GapBox& gap_;
  std::array<std::ptrdiff_t, kPlateReach> strides_;
};

/// Half the derivative of the energy by a node's value: sum over the reach of row[n] * f(n).
using PlateRow = std::array<double, kPlateReach>;

/// The rows for every set of available nodes that was asked for, each made once. Number 0 is kWholePlate's.
class PlateRows {
 public:
  /// weights  c_a of the energy.
  explicit PlateRows(Vec3d weights);

  std::uint32_t number(std::uint32_t available);
  const PlateRow& operator[](std::uint32_t number) const { return rows_[number]; }

 private:
  Vec3d weights_;
  std::vector<PlateRow> rows_;
  std::unordered_map<std::uint32_t, std::uint32_t> numbers_;  // by set; looked up, never walked
};

}  // namespace geosis
