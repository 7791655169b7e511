#include "engine/simplify/build_lods.h"

#include <cmath>
#include <string>
#include <utility>

#include "engine/mesh/check.h"
#include "engine/mesh/corner_table.h"
#include "engine/simplify/reducer.h"
#include "engine/simplify/watch.h"
#include "engine/simplify/window_sizes.h"
#include "engine/simplify/working_mesh.h"

namespace geosis {
namespace {

constexpr float kLargestCoordinate = 131'072;  // voxels; beyond, float32 does not hold all lattice points

const Error kCancelled = {ErrorCode::cancelled, "levels of detail: cancelled"};

Error invalid(std::string message) {
  return {ErrorCode::invalid_argument, std::move(message)};
}

Result<void> check_ratios(const std::vector<double>& ratios) {
  if (ratios.empty()) return invalid("levels of detail: no ratios given");
  double previous = 2;
  for (const double ratio : ratios) {
    if (!(ratio > 0 && ratio <= 1)) {
      return invalid("levels of detail: ratio " + std::to_string(ratio) + "; expected a number in (0, 1]");
    }
    if (ratio >= previous) {
      return invalid("levels of detail: ratio " + std::to_string(ratio) + " after " + std::to_string(previous) +
                     "; expected falling ratios");
    }
    previous = ratio;
  }
  return {};
}

Result<void> check_positions(const std::vector<Vec3f>& positions) {
  for (std::size_t v = 0; v < positions.size(); ++v) {
    for (int axis = 0; axis < 3; ++axis) {
      const float x = positions[v][axis];
      const bool in_range = std::abs(x) <= kLargestCoordinate;  // false for NaN
      const float steps = in_range ? x * kLatticeStepsPerVoxel : 0.5f;
      if (steps == static_cast<float>(static_cast<std::int32_t>(steps))) continue;
      return invalid("vertex " + std::to_string(v) + ": coordinate " + std::to_string(x) +
                     "; expected a multiple of 1/64 within 131072 of zero");
    }
  }
  return {};
}

/// Asks between its steps whether anybody still wants it: each takes a while for millions of triangles.
Result<WorkingMesh> check_and_load(const IndexedMesh& m0, const Progress& progress) {
  if (auto on_lattice = check_positions(m0.positions); !on_lattice) return std::move(on_lattice).error();
  const auto table = build_corner_table(m0);
  if (!table) return table.error();
  if (progress.cancelled()) return kCancelled;
  if (auto fans = check_fans(*table, m0.positions.size()); !fans) return std::move(fans).error();
  if (progress.cancelled()) return kCancelled;
  return make_working_mesh(m0, *table);
}

std::int64_t triangles_for(double ratio, std::size_t triangles) {
  return static_cast<std::int64_t>(ratio * static_cast<double>(triangles) + 0.5);
}

}  // namespace

Result<LodHierarchy> build_lods_in_windows(IndexedMesh m0, const BuildLodsOptions& options, const WindowSizes& sizes,
                                           Progress& progress) {
  if (auto falling = check_ratios(options.ratios); !falling) return std::move(falling).error();
  progress.report("simplify", 0);
  auto working = check_and_load(m0, progress);
  if (!working) return std::move(working).error();
  const std::size_t all = m0.triangles.size();
  Watch watch(progress, static_cast<std::int64_t>(all) - triangles_for(options.ratios.back(), all));
  Reducer reducer(*std::move(working), sizes, options.threads, watch);

  LodHierarchy hierarchy;
  for (const double ratio : options.ratios) {
    if (ratio == 1) {
      hierarchy.levels.emplace_back().mesh = std::move(m0);
      continue;
    }
    const std::int64_t target = triangles_for(ratio, all);
    if (!reducer.reduce(target)) return kCancelled;
    LodLevel& level = hierarchy.levels.emplace_back(reducer.snapshot());
    level.asked_ratio = ratio;
    level.cost = reducer.max_cost();
    if (reducer.at_floor()) level.stopped_by = StoppedBy::floor;
  }
  return hierarchy;
}

Result<LodHierarchy> build_lods(IndexedMesh m0, const BuildLodsOptions& options, Progress& progress) {
  return build_lods_in_windows(std::move(m0), options, {}, progress);
}

}  // namespace geosis
