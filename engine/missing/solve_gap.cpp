#include "engine/missing/solve_gap.h"

#include <limits>
#include <memory>
#include <utility>

#include "engine/missing/inverse_distance/inverse_distance.h"
#include "engine/missing/plate/steered_plate.h"
#include "engine/missing/plate/thin_plate.h"

namespace geosis {
namespace {

Error cancelled() {
  return {ErrorCode::cancelled, "filling missing samples was cancelled"};
}

/// Nothing is filled with what no sample has: a plate can swing far beyond its rim.
ThinPlateOptions clamped_to_samples(const BrickedVolume& volume) {
  const ValueRange range = value_range(volume);
  return {.low = range.min, .high = range.max};
}

/// Gaps along whose surroundings the plate may be steered. Automatic: dips are smoothed over a few traces, so the
/// middle of much wider gaps hears of none, and steering costs ten times the plain plate.
WideGaps steerable(FillSteering steer) {
  WideGaps wide;
  wide.margin = {kSteeringMarginTraces, kSteeringMarginTraces, kSteeringMarginSamples};
  if (steer == FillSteering::automatic) {
    wide.first = kLeastSteeredTraces;
    wide.last = 40;
  } else if (steer == FillSteering::on) {
    wide.last = std::numeric_limits<std::int32_t>::max();
  }
  return wide;
}

GapMethod plate_method(const BrickedVolume& volume, FillSteering steer, Vec3d step_lengths) {
  GapMethod method;
  method.wide = steerable(steer);
  method.solve = [steer, step_lengths, options = clamped_to_samples(volume)](GapBox& gap,
                                                                             Progress& progress) -> Result<void> {
    if (gap.wide && wants_steering(gap, steer, progress)) {
      fill_steered_plate(gap, step_lengths, options, progress);
    } else {
      fill_thin_plate(gap, step_lengths, options, progress);
    }
    if (progress.cancelled()) return cancelled();
    return {};
  };
  return method;
}

Result<GapMethod> inverse_distance_method(const BrickedVolume& volume, Vec3d step_lengths, int threads,
                                          Progress& progress) {
  auto built = InverseDistanceFill::build(volume, step_lengths, threads, progress);
  if (!built) return std::move(built).error();
  GapMethod method;
  method.solve = [fill = std::make_shared<const InverseDistanceFill>(*std::move(built))](
                     GapBox& gap, Progress& unfinished) { return fill->fill(gap, unfinished); };
  return method;
}

}  // namespace

Result<GapMethod> make_gap_method(const BrickedVolume& volume, const FillOptions& options, Vec3d step_lengths,
                                  int threads, Progress& progress) {
  switch (options.kernel) {
    case RbfKernel::polyharmonic:
      return plate_method(volume, options.steer, step_lengths);
    case RbfKernel::inverse_distance:
      return inverse_distance_method(volume, step_lengths, threads, progress);
  }
  return Error{ErrorCode::internal, "filling with an unknown kernel"};
}

}  // namespace geosis
