#include "engine/simplify/reducer.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace geosis {
namespace {

constexpr double kKeepInPass = 0.4;        // share of the triangles that a pass leaves at least
constexpr double kKeepInLastPass = 0.6;    // a gentle one: what stays locked in it is then not much denser
constexpr double kFloorTolerance = 1.005;  // a level within this of what was asked has not stopped early
constexpr double kCloseEnough = 1.001;     // not worth another pass
constexpr double kLeastProgress = 0.005;   // share of the triangles; a last pass that removes less is at the floor
constexpr int kMostPasses = 12;            // a level

bool is_floor(std::int64_t triangles, std::int64_t target) {
  return triangles > target + 1 && static_cast<double>(triangles) > kFloorTolerance * static_cast<double>(target);
}

}  // namespace

Reducer::Reducer(WorkingMesh mesh, const WindowSizes& sizes, int threads, Watch& watch)
    : mesh_(std::move(mesh)), sizes_(sizes), threads_(threads), watch_(watch) {}

bool Reducer::reduce(std::int64_t target) {
  if (at_floor_) return true;
  if (!whole_ && !reduce_by_passes(target)) return false;
  if (whole_ && !whole_->reduce(target, watch_)) return false;
  at_floor_ = is_floor(triangles(), target);
  return true;
}

std::int64_t Reducer::triangles() const {
  return whole_ ? whole_->triangles() : static_cast<std::int64_t>(mesh_.triangles.size());
}

double Reducer::max_cost() const {
  return whole_ ? std::max(mesh_.max_cost, whole_->max_cost()) : mesh_.max_cost;
}

LodLevel Reducer::snapshot() const {
  if (!whole_) return to_level(mesh_);
  WorkingMesh now{std::vector<WorkingVertex>(mesh_.vertices.size()), {}, {}};
  std::vector<LocalTriangle> triangles(static_cast<std::size_t>(whole_->triangles()));
  std::vector<std::int32_t> place(mesh_.vertices.size());
  whole_->store(now.vertices, triangles, place);
  for (const auto [a, b, c] : triangles) now.triangles.push_back({a, b, c});
  return to_level(now);
}

bool Reducer::fits(std::int32_t size) const {
  return mesh_.vertices.size() <= static_cast<std::size_t>(size);
}

/// Passes over windows until the target is reached, a whole pass with large windows changes next to nothing, or the
/// mesh fits one window.
bool Reducer::reduce_by_passes(std::int64_t target) {
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
PassOptions Reducer::plan_pass(std::int64_t target, bool first, bool stuck) const {
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

void Reducer::load_whole() {
  std::vector<LocalTriangle> triangles;
  triangles.reserve(mesh_.triangles.size());
  for (const auto& [a, b, c] : mesh_.triangles) {
    triangles.push_back({static_cast<LocalVertex>(a), static_cast<LocalVertex>(b), static_cast<LocalVertex>(c)});
  }
  for (WorkingVertex& v : mesh_.vertices) v.locked = false;
  whole_ = std::make_unique<Window>();
  whole_->load(mesh_.vertices, triangles, mesh_.bounds);
}

}  // namespace geosis
