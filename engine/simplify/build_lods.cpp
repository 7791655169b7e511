#include "engine/simplify/build_lods.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <optional>
#include <string>
#include <utility>

#include "engine/mesh/check.h"
#include "engine/mesh/corner_table.h"
#include "engine/simplify/pass.h"
#include "engine/simplify/watch.h"
#include "engine/simplify/window.h"
#include "engine/simplify/window_sizes.h"
#include "engine/simplify/working_mesh.h"

namespace geosis {
namespace {

constexpr float kLargestCoordinate = 131'072;  // voxels; beyond, float32 does not hold all lattice points
constexpr double kKeepInPass = 0.4;            // share of the triangles that a pass leaves at least
constexpr double kKeepInLastPass = 0.6;        // a gentle one: what stays locked in it is then not much denser
constexpr double kFloorTolerance = 1.005;      // a level within this of what was asked has not stopped early
constexpr double kCloseEnough = 1.001;         // not worth another pass
constexpr double kLeastProgress = 0.005;       // share of the triangles; a last pass that removes less is at the floor
constexpr int kMostPasses = 12;                // a level

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

Result<WorkingMesh> check_and_load(const IndexedMesh& m0) {
  if (auto on_lattice = check_positions(m0.positions); !on_lattice) return std::move(on_lattice).error();
  const auto table = build_corner_table(m0);
  if (!table) return table.error();
  if (auto fans = check_fans(*table, m0.positions.size()); !fans) return std::move(fans).error();
  return make_working_mesh(m0, *table);
}

bool is_floor(std::int64_t triangles, std::int64_t target) {
  return triangles > target + 1 && static_cast<double>(triangles) > kFloorTolerance * static_cast<double>(target);
}

/// Takes the mesh down from level to level: in many windows while it is large, then in one.
class Reducer {
 public:
  Reducer(WorkingMesh mesh, const WindowSizes& sizes, int threads, Watch& watch)
      : mesh_(std::move(mesh)), sizes_(sizes), threads_(threads), watch_(watch) {}

  std::int64_t triangles() const {
    return whole_ ? whole_->triangles() : static_cast<std::int64_t>(mesh_.triangles.size());
  }

  /// Removes triangles until `target` are left, or as many as can go. False if cancelled.
  bool reduce(std::int64_t target) {
    if (at_floor_) return true;
    if (!whole_ && !reduce_by_passes(target)) return false;
    if (whole_ && !whole_->reduce(target, watch_)) return false;
    at_floor_ = is_floor(triangles(), target);
    return true;
  }

  bool at_floor() const { return at_floor_; }  ///< fewer triangles than now were asked for and could not be had

  double max_cost() const { return whole_ ? std::max(mesh_.max_cost, whole_->max_cost()) : mesh_.max_cost; }

  IndexedMesh snapshot() {
    if (!whole_) return to_indexed_mesh(mesh_);
    WorkingMesh now{std::vector<WorkingVertex>(mesh_.vertices.size()), {}, {}};
    std::vector<LocalTriangle> triangles(static_cast<std::size_t>(whole_->triangles()));
    std::vector<std::int32_t> place(mesh_.vertices.size());
    whole_->store(now.vertices, triangles, place);
    for (const auto [a, b, c] : triangles) now.triangles.push_back({a, b, c});
    return to_indexed_mesh(now);
  }

 private:
  bool fits(std::int32_t size) const { return mesh_.vertices.size() <= static_cast<std::size_t>(size); }

  /// Passes over windows until the target is reached, a whole pass with large windows changes next to nothing, or the
  /// mesh fits one window.
  bool reduce_by_passes(std::int64_t target) {
    bool stuck = false;
    for (int i = 0; i < kMostPasses; ++i) {
      if (fits(i == 0 ? sizes_.whole_mesh : sizes_.last_pass)) {
        load_whole();
        return true;
      }
      const std::int64_t before = triangles();
      if (static_cast<double>(before) <= kCloseEnough * static_cast<double>(target)) return true;
      const PassOptions pass = plan_pass(target, i == 0, stuck);
      if (!run_pass(mesh_, pass, watch_)) return false;
      ++passes_;
      const auto removed = static_cast<double>(before - triangles());
      const bool small_step = removed < kLeastProgress * static_cast<double>(before);
      if (small_step && pass.last) return true;
      stuck = stuck || small_step;
    }
    return true;
  }

  /// Small windows first, for speed. Then a gentle last pass with large ones.
  PassOptions plan_pass(std::int64_t target, bool first, bool stuck) const {
    const auto now = static_cast<double>(triangles());
    const double ratio = static_cast<double>(target) / now;
    PassOptions pass{target, sizes_.last_pass, passes_, true, threads_};
    if (stuck || (!first && ratio > 0.8 * kKeepInLastPass)) return pass;
    const double keep = std::max(kKeepInPass, std::min(ratio / kKeepInLastPass, std::sqrt(ratio)));
    pass.target = static_cast<std::int64_t>(keep * now);
    pass.window_size = sizes_.pass;
    pass.last = false;
    return pass;
  }

  void load_whole() {
    std::vector<LocalTriangle> triangles;
    triangles.reserve(mesh_.triangles.size());
    for (const auto& [a, b, c] : mesh_.triangles) {
      triangles.push_back({static_cast<LocalVertex>(a), static_cast<LocalVertex>(b), static_cast<LocalVertex>(c)});
    }
    for (WorkingVertex& v : mesh_.vertices) v.locked = false;
    whole_ = std::make_unique<Window>();
    whole_->load(mesh_.vertices, triangles, mesh_.bounds);
  }

  WorkingMesh mesh_;
  const WindowSizes sizes_;
  const int threads_;
  Watch& watch_;
  std::uint32_t passes_ = 0;
  bool at_floor_ = false;
  std::unique_ptr<Window> whole_;  // holds the mesh from the moment it fits
};

std::int64_t triangles_for(double ratio, std::size_t triangles) {
  return static_cast<std::int64_t>(ratio * static_cast<double>(triangles) + 0.5);
}

}  // namespace

Result<LodHierarchy> build_lods_in_windows(IndexedMesh m0, const BuildLodsOptions& options, const WindowSizes& sizes,
                                           Progress& progress) {
  if (auto falling = check_ratios(options.ratios); !falling) return std::move(falling).error();
  auto working = check_and_load(m0);
  if (!working) return std::move(working).error();
  const std::size_t all = m0.triangles.size();
  Watch watch(progress, static_cast<std::int64_t>(all) - triangles_for(options.ratios.back(), all));
  Reducer reducer(*std::move(working), sizes, options.threads, watch);

  LodHierarchy hierarchy;
  for (const double ratio : options.ratios) {
    LodLevel& level = hierarchy.levels.emplace_back();
    level.asked_ratio = ratio;
    if (ratio == 1) {
      level.mesh = std::move(m0);
      continue;
    }
    const std::int64_t target = triangles_for(ratio, all);
    if (!reducer.reduce(target)) return Error{ErrorCode::cancelled, "levels of detail: cancelled"};
    level.mesh = reducer.snapshot();
    level.cost = reducer.max_cost();
    if (reducer.at_floor()) level.stopped_by = StoppedBy::floor;
  }
  return hierarchy;
}

Result<LodHierarchy> build_lods(IndexedMesh m0, const BuildLodsOptions& options, Progress& progress) {
  return build_lods_in_windows(std::move(m0), options, {}, progress);
}

}  // namespace geosis
