#pragma once

namespace geosis {

struct ThinPlateOptions {
  double tolerance = 1e-3;  ///< of the residual, beside what it was at the start
  float low = 0, high = 0;  ///< filled values are cut to [low, high]
};

}  // namespace geosis
