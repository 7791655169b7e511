#include "engine/missing/solve_gap.h"

namespace geosis {

Result<GapMethod> make_gap_method(const BrickedVolume&, const FillOptions& options, Vec3d, int, Progress&) {
  switch (options.kernel) {
    case RbfKernel::polyharmonic:
      return Error{ErrorCode::unsupported, "filling with the polyharmonic kernel"};
    case RbfKernel::inverse_distance:
      return Error{ErrorCode::unsupported, "filling with the inverse distance kernel"};
  }
  return Error{ErrorCode::internal, "filling with an unknown kernel"};
}

}  // namespace geosis
