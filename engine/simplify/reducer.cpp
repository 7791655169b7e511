#include "engine/simplify/reducer.h"

#include <algorithm>
#include <cmath>
#include <numeric>
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

bool is_short_of(std::int64_t triangles, std::int64_t target) {
  return triangles > target + 1 && static_cast<double>(triangles) > kFloorTolerance * static_cast<double>(target);
}

}  // namespace

Reducer::Reducer(const IndexedMesh& m0, const ReducerOptions& options, Watch& watch)
    : mesh_(m0, options.threads), options_(options), watch_(&watch) {}

Reducer::Reducer(const Reducer& other)
    : mesh_(other.mesh_.clone()),
      options_(other.options_),
      watch_(other.watch_),
      passes_(other.passes_),
      max_cost_(other.max_cost_),
      capped_(other.capped_),
      stopped_by_(other.stopped_by_),
      whole_(other.whole_ ? std::make_unique<Window>(*other.whole_) : nullptr) {}

PassEnd Reducer::reduce(const Goal& goal) {
  if (stopped_by_ == StoppedBy::floor) return PassEnd::done;
  capped_ = false;
  if (!whole_) {
    const PassEnd end = reduce_by_passes(goal);
    if (end != PassEnd::done) return end;
  }
  if (whole_) {
    if (!whole_->reduce(goal, options_.rules, *watch_)) return PassEnd::cancelled;
    max_cost_ = std::max(max_cost_, whole_->max_cost());
    capped_ = whole_->capped();
  }
  stopped_by_ = !is_short_of(triangles(), goal.triangles) ? StoppedBy::none
                : capped_                                 ? StoppedBy::error_cap
                                                          : StoppedBy::floor;
  return PassEnd::done;
}

std::int64_t Reducer::triangles() const {
  return whole_ ? whole_->triangles() : static_cast<std::int64_t>(mesh_.triangles().size());
}

LodLevel Reducer::snapshot() const {
  return whole_ ? to_level(store_whole(), 1) : to_level(mesh_, options_.threads);
}

PassEnd Reducer::remove(const std::function<bool(std::int32_t origin)>& goes) {
  if (mesh_.m0()) {  // a pass that removes nothing gives the vertices their records
    const PassOptions nothing{{triangles()}, options_.rules, options_.sizes.pass, passes_, false, options_.threads};
    const PassEnd end = run_pass(mesh_, nothing, *watch_).end;
    if (end != PassEnd::done) return end;
  }
  if (whole_) mesh_ = store_whole();
  whole_ = nullptr;
  mesh_ = without(mesh_, goes);
  stopped_by_ = StoppedBy::none;
  return PassEnd::done;
}

bool Reducer::fits(std::int32_t size) const {
  return mesh_.vertices() <= static_cast<std::size_t>(size);
}

/// Passes over windows until the target is reached, a whole pass with large windows changes next to nothing, or the
/// mesh fits one window.
PassEnd Reducer::reduce_by_passes(const Goal& goal) {
  bool stuck = false;
  for (int i = 0; i < kMostPasses; ++i) {
    const std::int64_t before = triangles();
    if (static_cast<double>(before) <= kCloseEnough * static_cast<double>(goal.triangles)) return PassEnd::done;
    if (fits(i == 0 ? options_.sizes.whole_mesh : options_.sizes.last_pass)) {
      return load_whole() ? PassEnd::done : PassEnd::not_manifold;
    }
    const PassOptions pass = plan_pass(goal, i == 0, stuck);
    const PassResult result = run_pass(mesh_, pass, *watch_);
    if (result.end != PassEnd::done) return result.end;
    max_cost_ = std::max(max_cost_, result.max_cost);
    capped_ = result.capped;
    ++passes_;
    const auto removed = static_cast<double>(before - triangles());
    const bool small_step = removed < kLeastProgress * static_cast<double>(before);
    if (small_step && pass.last) return PassEnd::done;
    stuck = stuck || small_step;
  }
  return PassEnd::done;
}

/// Small windows first, for speed. Then a gentle last pass with large ones.
PassOptions Reducer::plan_pass(const Goal& goal, bool first, bool stuck) const {
  const auto now = static_cast<double>(triangles());
  const double ratio = static_cast<double>(goal.triangles) / now;
  PassOptions pass{goal, options_.rules, options_.sizes.last_pass, passes_, true, options_.threads};
  if (stuck || (!first && ratio > 0.8 * kKeepInLastPass)) return pass;
  const double keep = std::max(kKeepInPass, std::min(ratio / kKeepInLastPass, std::sqrt(ratio)));
  pass.goal.triangles = static_cast<std::int64_t>(keep * now);
  // What the first pass folds over is of M0's size, and later collapses smooth nearly all of it out.
  pass.goal.refuse_folds = mesh_.m0() == nullptr;
  pass.goal.is_followed = true;
  pass.window_size = options_.sizes.pass;
  pass.last = false;
  return pass;
}

/// False if the mesh is M0 and no manifold.
bool Reducer::load_whole() {
  std::vector<WorkingVertex> vertices;
  vertices.reserve(mesh_.vertices());
  std::vector<LocalVertex> place(mesh_.slots());
  for (const auto& [begin, end] : mesh_.segments()) {
    for (std::size_t v = begin; v < end; ++v) {
      place[v] = static_cast<LocalVertex>(vertices.size());
      vertices.push_back(mesh_.vertex(v));
      vertices.back().locked = false;
    }
  }
  std::vector<LocalTriangle> triangles;
  triangles.reserve(mesh_.triangles().size());
  for (const auto& [a, b, c] : mesh_.triangles()) triangles.push_back({place[a], place[b], place[c]});
  whole_ = std::make_unique<Window>();
  whole_->load(std::move(vertices), triangles, mesh_.bounds());
  const bool sound = !mesh_.m0() || whole_->start(triangles);
  mesh_ = WorkingMesh({}, {}, {}, mesh_.bounds());
  return sound;
}

WorkingMesh Reducer::store_whole() const {
  Buffer<WorkingVertex> vertices(whole_->vertices());
  std::vector<std::int32_t> place(whole_->vertices());
  std::vector<LocalTriangle> local(static_cast<std::size_t>(whole_->triangles()));
  const Window::Stored stored = whole_->store({vertices.data(), vertices.size()}, local, place);
  Buffer<Triangle> triangles(local.size());
  for (std::size_t t = 0; t < local.size(); ++t) triangles[t] = {local[t][0], local[t][1], local[t][2]};
  return WorkingMesh(std::move(vertices), {{0, stored.vertices}}, std::move(triangles), mesh_.bounds());
}

}  // namespace geosis
