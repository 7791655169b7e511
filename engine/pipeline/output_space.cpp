#include "engine/pipeline/output_space.h"

#include <array>

namespace geosis {
namespace {

constexpr double kMsPerSecond = 1000;

/// The vertical axis scaled.
AffineGeometry with_vertical_scale(const std::array<double, 16>& m, double scale) {
  return AffineGeometry({m[3], m[7], m[11] * scale}, {m[0], m[4], m[8] * scale}, {m[1], m[5], m[9] * scale},
                        {m[2], m[6], m[10] * scale});
}

}  // namespace

double vertical_scale_of(const ReconstructOptions& options) {
  // Down to the reflector and up again: the way there takes half the time.
  return options.velocity ? *options.velocity / 2 / kMsPerSecond : 1;
}

Result<AffineGeometry> output_space(const GridGeometry& geometry, const ReconstructOptions& options) {
  if (options.index_space) return AffineGeometry();
  if (geometry.affine() == nullptr) {
    return Error{ErrorCode::unsupported, "world space of a grid that is not affine; ask for index space"};
  }
  return with_vertical_scale(*geometry.affine(), vertical_scale_of(options));
}

}  // namespace geosis
