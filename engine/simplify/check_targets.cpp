#include "engine/simplify/check_targets.h"

#include <string>
#include <utility>

namespace geosis {
namespace {

Error invalid(std::string message) {
  return {ErrorCode::invalid_argument, "levels of detail: " + std::move(message)};
}

Result<void> check_ratio(double ratio, double previous) {
  if (!(ratio > 0 && ratio <= 1)) {
    return invalid("ratio " + std::to_string(ratio) + "; expected a number in (0, 1]");
  }
  if (ratio >= previous) {
    return invalid("ratio " + std::to_string(ratio) + " after " + std::to_string(previous) +
                   "; expected falling ratios");
  }
  return {};
}

/// Of max_error and max_cost: larger means coarser.
Result<void> check_growing(const char* name, double bound, double previous) {
  if (!(bound > 0)) return invalid(std::string(name) + " " + std::to_string(bound) + "; expected a number above 0");
  if (bound <= previous) {
    return invalid(std::string(name) + " " + std::to_string(bound) + " after " + std::to_string(previous) +
                   "; expected growing numbers");
  }
  return {};
}

Result<void> check_alone(const LevelTarget& target) {
  if (target.ratio.has_value() + target.max_error.has_value() + target.max_cost.has_value() != 1) {
    return invalid("expected one of ratio, max_error and max_cost for each level");
  }
  if (target.error_cap && !(*target.error_cap >= 0)) {
    return invalid("error_cap " + std::to_string(*target.error_cap) + "; expected a number from 0 on");
  }
  if (!(target.drop.max_voxels >= 0 && target.drop.max_error >= 0)) {
    return invalid("drop of " + std::to_string(target.drop.max_voxels) + " voxels and error " +
                   std::to_string(target.drop.max_error) + "; expected numbers from 0 on");
  }
  return {};
}

}  // namespace

Result<void> check_targets(const BuildLodsOptions& options) {
  if (options.levels.empty()) return invalid("no levels given");
  double ratio = 2;
  double error = 0;
  double cost = 0;
  for (const LevelTarget& target : options.levels) {
    if (auto alone = check_alone(target); !alone) return alone;
    Result<void> in_order;
    if (target.ratio) in_order = check_ratio(*target.ratio, std::exchange(ratio, *target.ratio));
    if (target.max_error)
      in_order = check_growing("max_error", *target.max_error, std::exchange(error, *target.max_error));
    if (target.max_cost) in_order = check_growing("max_cost", *target.max_cost, std::exchange(cost, *target.max_cost));
    if (!in_order) return in_order;
    if (target.max_error && !options.measure) return invalid("max_error without a way to measure it");
  }
  return {};
}

}  // namespace geosis
