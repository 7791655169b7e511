#include "engine/simplify/pass.h"

#include <algorithm>
#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "engine/base/parallel.h"
#include "engine/simplify/locked_stars.h"
#include "engine/simplify/partition.h"
#include "engine/simplify/window.h"

namespace geosis {
namespace {

/// Windows that wait for work, so that each thread reuses its memory.
class WindowPool {
 public:
  std::unique_ptr<Window> take() {
    const std::lock_guard lock(mutex_);
    if (idle_.empty()) return std::make_unique<Window>();
    auto window = std::move(idle_.back());
    idle_.pop_back();
    return window;
  }
  void give_back(std::unique_ptr<Window> window) {
    const std::lock_guard lock(mutex_);
    idle_.push_back(std::move(window));
  }

 private:
  std::mutex mutex_;
  std::vector<std::unique_ptr<Window>> idle_;
};

/// What each window is to remove. They share by free vertices: counting the locked ones too would make the inside of
/// windows with long seams pay for the seams.
std::vector<std::int64_t> share_out(const Partition& partition, std::int64_t triangles, const PassOptions& options) {
  std::vector<std::int64_t> share(partition.windows);
  std::int64_t all_free = 0;
  for (std::int32_t w = 0; w < partition.windows; ++w) {
    const auto first = partition.locked.begin() + partition.first_vertex(w);
    share[w] = std::count(first, first + partition.vertices(w), std::uint8_t{0});
    all_free += share[w];
  }
  const auto remove = static_cast<double>(triangles - options.goal.triangles);
  // A vertex takes two triangles along. A pass that others follow leaves what windows with few free vertices cannot
  // give in fairness to those.
  const double most = options.last ? 2.0 : 2.0 * remove / static_cast<double>(triangles);
  const double per_vertex = std::min(remove / static_cast<double>(std::max<std::int64_t>(all_free, 1)), most);
  for (std::int64_t& s : share) s = static_cast<std::int64_t>(per_vertex * static_cast<double>(s) + 0.5);
  return share;
}

/// What the windows left: window w's vertices from partition.first_vertex(w) on, its triangles over those in the
/// partition's own place.
struct WindowResults {
  Buffer<WorkingVertex> vertices;
  Buffer<std::int32_t> place;  // place in the partition -> index among the window's remaining vertices
  std::vector<Window::Stored> stored;
  std::vector<float> max_cost;
  std::vector<std::uint8_t> capped;
};

class Pass {
 public:
  Pass(WorkingMesh& mesh, const PassOptions& options, Watch& watch)
      : mesh_(mesh),
        options_(options),
        watch_(watch),
        partition_(make_partition(mesh, options.window_size, options.number, options.threads)) {}

  PassResult run() {
    if (partition_.windows == 0) return {};
    if (watch_.is_cancelled()) return {PassEnd::cancelled};
    if (mesh_.m0()) locked_.emplace(mesh_, partition_, options_.threads, watch_);
    if ((locked_ && !locked_->is_made()) || watch_.is_cancelled()) return {PassEnd::cancelled};
    if (locked_ && !locked_->is_manifold()) return {PassEnd::not_manifold};
    const auto share = share_out(partition_, static_cast<std::int64_t>(mesh_.triangles().size()), options_);
    const auto windows = static_cast<std::size_t>(partition_.windows);
    results_ = {Buffer<WorkingVertex>(mesh_.vertices()), Buffer<std::int32_t>(mesh_.vertices()),
                std::vector<Window::Stored>(windows), std::vector<float>(windows), std::vector<std::uint8_t>(windows)};
    parallel_for(windows, options_.threads,
                 [&](std::size_t w) { reduce_window(static_cast<std::int32_t>(w), share[w]); });
    if (end_ != PassEnd::done) return {end_};
    join();
    return {PassEnd::done, *std::max_element(results_.max_cost.begin(), results_.max_cost.end()),
            std::count(results_.capped.begin(), results_.capped.end(), 1) > 0};
  }

 private:
  void reduce_window(std::int32_t w, std::int64_t share) {
    if (end_ != PassEnd::done) return;
    auto window = pool_.take();
    const auto triangles = partition_.triangles_of(w);
    window->load(gather(w, window->take_vertices()), triangles, mesh_.bounds());
    if (mesh_.m0() && !window->start(triangles)) {
      end_ = PassEnd::not_manifold;
      return;
    }
    Goal goal = options_.goal;
    goal.triangles = static_cast<std::int64_t>(triangles.size()) - share;
    Rules rules = options_.rules;
    rules.seed += std::uint64_t{options_.number} << 32 | static_cast<std::uint32_t>(w);
    if (!window->reduce(goal, rules, watch_)) {
      end_ = PassEnd::cancelled;
      return;
    }
    const auto first = static_cast<std::size_t>(partition_.first_vertex(w));
    const auto count = static_cast<std::size_t>(partition_.vertices(w));
    results_.stored[w] = window->store({&results_.vertices[first], count}, triangles, {&results_.place[first], count});
    results_.max_cost[w] = window->max_cost();
    results_.capped[w] = window->capped();
    pool_.give_back(std::move(window));
  }

  std::vector<WorkingVertex> gather(std::int32_t w, std::vector<WorkingVertex> vertices) const {
    const std::int32_t first = partition_.first_vertex(w);
    vertices.resize(partition_.vertices(w));
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      const std::size_t place = first + i;
      const bool locked = partition_.locked[place];
      vertices[i] = locked && locked_ ? locked_->at(place) : mesh_.vertex(partition_.order[place]);
      vertices[i].locked = locked;
    }
    return vertices;
  }

  /// The windows' remains, one window after the other, each followed by the triangles that leave it.
  void join() {
    std::vector<Segment> segments(partition_.windows);
    std::vector<std::size_t> first(partition_.windows + 1, 0);
    for (std::int32_t w = 0; w < partition_.windows; ++w) {
      const auto begin = static_cast<std::size_t>(partition_.first_vertex(w));
      segments[w] = {begin, begin + results_.stored[w].vertices};
      first[w + 1] = first[w] + results_.stored[w].triangles + partition_.crossing_of(w).size();
    }
    Buffer<Triangle> triangles(first.back());
    parallel_for(static_cast<std::size_t>(partition_.windows), options_.threads,
                 [&](std::size_t w) { join_window(static_cast<std::int32_t>(w), triangles.data() + first[w]); });
    mesh_ = WorkingMesh(std::move(results_.vertices), std::move(segments), std::move(triangles), mesh_.bounds());
  }

  void join_window(std::int32_t w, Triangle* out) {
    const std::int32_t offset = partition_.first_vertex(w);
    for (const auto [a, b, c] : partition_.triangles_of(w).first(results_.stored[w].triangles)) {
      *out++ = {offset + a, offset + b, offset + c};
    }
    const std::int32_t window_mask = ~(partition_.window_size - 1);
    const auto joined = [&](std::int32_t place) { return (place & window_mask) + results_.place[place]; };
    for (const auto& [a, b, c] : partition_.crossing_of(w)) *out++ = {joined(a), joined(b), joined(c)};
  }

  WorkingMesh& mesh_;
  const PassOptions& options_;
  Watch& watch_;
  Partition partition_;
  std::optional<LockedStars> locked_;  // in the first pass
  WindowResults results_;
  WindowPool pool_;
  std::atomic<PassEnd> end_ = PassEnd::done;
};

}  // namespace

PassResult run_pass(WorkingMesh& mesh, const PassOptions& options, Watch& watch) {
  return Pass(mesh, options, watch).run();
}

}  // namespace geosis
