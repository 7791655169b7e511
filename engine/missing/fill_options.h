#pragma once

#include <optional>

namespace geosis {

/// How missing samples get a value. The paper's three strategies.
enum class FillMethod {
  none,    ///< they stay missing
  linear,  ///< the axis barycentre of the nearest valid samples
  rbf,     ///< radial basis functions
};

enum class RbfKernel {
  polyharmonic,      ///< phi(r) = r: the thin plate on the grid
  inverse_distance,  ///< r^-6, normalised
};

/// Whether neighbours are taken along the reflectors instead of along the axes.
enum class FillSteering { automatic, on, off };

/// Part of a request: what is filled depends on nothing else but the volume.
struct FillOptions {
  FillMethod method = FillMethod::none;
  RbfKernel kernel = RbfKernel::polyharmonic;         ///< of rbf
  FillSteering steer = FillSteering::automatic;       ///< of the polyharmonic kernel
  std::optional<double> max_distance = std::nullopt;  ///< in steps: nodes further from every valid one stay missing

  bool operator==(const FillOptions&) const = default;
};

}  // namespace geosis
