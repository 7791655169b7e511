#include "engine/simplify/window.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <limits>
#include <utility>

#include "engine/simplify/edge_cost.h"
#include "engine/simplify/first_star.h"
#include "engine/simplify/fold_check.h"

namespace geosis {
namespace {

/// Share of a merged quadric that is replaced by the planes of the present triangles. Half the memory gives less error
/// than all of it, and fewer vanishing ends of thin bodies than none.
constexpr float kFreshShare = 0.5f;

/// After a collapse only edges up to this multiple of the cheapest one around are worth queueing.
constexpr float kQueueLimit = 2.0f;

constexpr int kChoices = 8;          // edges to choose from: the paper's Table 1
constexpr int kMostRefusals = 1000;  // in a row; what is left then will hardly collapse

constexpr std::int64_t kTrianglesBetweenReports = 8192;

using Costs = std::array<float, (kMaxDegree + kLanes) / kLanes * kLanes>;

bool nearer(Vec3f place, Vec3f p, Vec3f q) {
  return dot(p - place, p - place) < dot(q - place, q - place);
}

}  // namespace

void Window::load(std::vector<WorkingVertex> vertices, std::span<const LocalTriangle> triangles, const Box& bounds) {
  assert(vertices.size() <= kMaxVertices);
  vertices_ = std::move(vertices);
  bounds_ = bounds;
  triangles_ = static_cast<std::int64_t>(triangles.size());
  max_cost_ = 0;
  queued_ = false;
  rings_.build(vertices_.size(), triangles);
  version_.assign(vertices_.size(), 0);
  marks_.reset(vertices_.size());
}

bool Window::start(std::span<const LocalTriangle> triangles) {
  for (const auto& [a, b, c] : triangles) add_triangle_plane(vertices_[a], vertices_[b], vertices_[c]);
  const auto position = [&](LocalVertex v) { return vertices_[v].position; };
  ClosedFans closed(vertices_.size());
  for (std::size_t i = 0; i < vertices_.size(); ++i) {
    const auto v = static_cast<LocalVertex>(i);
    if (vertices_[v].locked || closed.is_closed_fan(v, rings_.of(v))) continue;
    const Fan<RingTriangle> fan(v, rings_.of(v));
    if (!fan.is_sound()) return false;
    if (fan.is_open()) add_boundary_planes(vertices_[v], fan, position);
  }
  return true;
}

bool Window::reduce(const Goal& goal, const Rules& rules, Watch& watch) {
  goal_ = goal;
  rules_ = rules;
  capped_ = false;
  return rules.strategy == Strategy::greedy ? reduce_greedily(watch) : reduce_by_multiple_choice(watch);
}

bool Window::reduce_greedily(Watch& watch) {
  if (!std::exchange(queued_, true)) queue_all_edges();
  while (triangles_ > goal_.triangles) {
    const std::int64_t before = triangles_;
    if (!collapse_cheapest_first(watch)) return false;
    if (triangles_ <= goal_.triangles) break;
    // The queue ran empty. What was refused or not worth queueing gets another chance, as long as that leads anywhere.
    queue_all_edges();
    if (before - triangles_ <= before / 1000) break;
  }
  return true;
}

Neighbours Window::free_neighbours(LocalVertex u) const {
  if (vertices_[u].locked || rings_.degree(u) > kMaxDegree) return {};
  return neighbours_of(u, vertices_[u].on_boundary, rings_, [&](LocalVertex v) { return !vertices_[v].locked; });
}

void Window::queue_all_edges() {
  queue_.clear();
  queue_.reserve(3 * vertices_.size());
  Costs costs;
  for (std::size_t i = 0; i < vertices_.size(); ++i) {
    const auto u = static_cast<LocalVertex>(i);
    if (vertices_[u].locked || rings_.degree(u) > kMaxDegree) continue;
    const Neighbours around = neighbours_of(u, vertices_[u].on_boundary, rings_,
                                            [&](LocalVertex v) { return v > u && !vertices_[v].locked; });
    if (around.count == 0) continue;
    edge_costs(vertices_, u, around, costs, rules_.placement);
    for (int k = 0; k < around.count; ++k) push(u, around.ids[k], costs[k]);
  }
}

void Window::queue_edges_around(LocalVertex u) {
  const Neighbours around = free_neighbours(u);
  if (around.count == 0) return;
  Costs costs;
  edge_costs(vertices_, u, around, costs, rules_.placement);
  const float limit = kQueueLimit * *std::min_element(costs.begin(), costs.begin() + around.count);
  for (int k = 0; k < around.count; ++k) {
    if (costs[k] <= limit) push(u, around.ids[k], costs[k]);
  }
}

void Window::push(LocalVertex u, LocalVertex v, float cost) {
  queue_.push({u, v, version_[u], version_[v]}, cost);
}

void Window::prefetch(const QueuedEdge& edge) const {
  for (const LocalVertex v : {edge.u, edge.v}) {
    __builtin_prefetch(&vertices_[v]);
    rings_.prefetch(v);
  }
}

bool Window::collapse_cheapest_first(Watch& watch) {
  std::int64_t reported = triangles_;
  QueuedEdge edge;
  while (triangles_ > goal_.triangles && queue_.pop(edge)) {
    if (const QueuedEdge* next = queue_.likely_next()) prefetch(*next);
    if (version_[edge.u] != edge.version_u || version_[edge.v] != edge.version_v) continue;
    if (!try_collapse(edge.u, edge.v)) continue;
    queue_edges_around(edge.u);
    if (reported - triangles_ < kTrianglesBetweenReports) continue;
    if (!watch.removed(reported - triangles_)) return false;
    reported = triangles_;
  }
  return watch.removed(reported - triangles_);
}

/// The paper's rule: of 8 random edges the cheapest collapses, whatever the others of the window cost.
bool Window::reduce_by_multiple_choice(Watch& watch) {
  RandomEdges random(rules_.seed);
  for (std::size_t v = 0; v < vertices_.size(); ++v) {
    if (!vertices_[v].locked) random.add(static_cast<LocalVertex>(v));
  }
  std::int64_t reported = triangles_;
  for (int refused = 0; triangles_ > goal_.triangles && refused < kMostRefusals;) {
    const QueuedEdge edge = cheapest_of_random(random);
    refused = edge.u != edge.v && try_collapse(edge.u, edge.v) ? 0 : refused + 1;
    if (reported - triangles_ < kTrianglesBetweenReports) continue;
    if (!watch.removed(reported - triangles_)) return false;
    reported = triangles_;
  }
  return watch.removed(reported - triangles_);
}

/// u == v when none was found.
QueuedEdge Window::cheapest_of_random(RandomEdges& random) {
  QueuedEdge best{0, 0, 0, 0};
  float least = std::numeric_limits<float>::infinity();
  Costs costs;
  for (int i = 0; i < kChoices; ++i) {
    LocalVertex u, v;
    if (!random.draw(rings_, u, v)) break;
    if (vertices_[v].locked || rings_.degree(u) > kMaxDegree || rings_.degree(v) > kMaxDegree) continue;
    edge_costs(vertices_, u, std::span(&v, 1), costs, rules_.placement);
    if (!(costs[0] < least)) continue;
    least = costs[0];
    best = {u, v, 0, 0};
  }
  return best;
}

/// weight    of the planes whose squared distances the cost sums up: an area.
bool Window::within_goal(float cost, float weight) {
  capped_ = capped_ || cost > goal_.max_cost || cost > goal_.max_error * goal_.max_error * weight;
  return !(cost > goal_.max_cost || cost > goal_.max_error * goal_.max_error * weight);
}

/// Merges v into u, if that keeps topology and shape.
bool Window::try_collapse(LocalVertex u, LocalVertex v) {
  MergedStar star;
  if (!find_merged_star(u, v, vertices_, rings_, marks_, star)) return false;
  WorkingVertex& kept = vertices_[u];
  const WorkingVertex& gone = vertices_[v];
  const Vec3f edge = gone.position - kept.position;
  const Quadric sum = kept.quadric() + seen_from(gone.quadric(), edge);
  Vec3f place = best_point(sum, edge, merge_target(kept, gone), rules_.placement);
  const bool on_boundary = kept.on_boundary || gone.on_boundary;
  StarShape shape;
  measure_star(star, u, v, vertices_, shape);
  if (!on_boundary && rules_.placement == Placement::optimal) place = keep_volume(shape, edge, place);
  const Vec3f position = snap_to_lattice(kept.position + place, bounds_);
  const MovedStar moved = move_star(star, shape, position);
  if (!moved.sound) return false;
  Quadric merged = seen_from(sum, kept.position - position);
  merged.c = std::max(merged.c, 0.0f);
  if (!within_goal(merged.c, merged.trace())) return false;
  if (goal_.refuse_folds && moved.sharp && folds_over(star, shape, u, v, position, vertices_, rings_, marks_))
    return false;

  max_cost_ = std::max(max_cost_, merged.c);
  // The planes that hold a boundary would fade away with the memory.
  kept.set_quadric(on_boundary ? merged : blend(merged, moved.planes, kFreshShare));
  if (nearer(position, gone.position, kept.position)) kept.origin = gone.origin;
  kept.position = position;
  kept.on_boundary = on_boundary;
  commit(u, v, star);
  return true;
}

void Window::commit(LocalVertex u, LocalVertex v, const MergedStar& star) {
  for (int i = 0; i < star.shared; ++i) rings_.remove_triangle(star.opposite[i], u, v);
  for (const LocalVertex w : neighbours_of(v, vertices_[v].on_boundary, rings_)) {
    if (w != u) rings_.rename(w, v, u);
  }
  rings_.merge(u, v, star.triangles());
  triangles_ -= star.shared;
  ++version_[u];
  ++version_[v];
}

Window::Stored Window::store(std::span<WorkingVertex> vertices, std::span<LocalTriangle> triangles,
                             std::span<std::int32_t> place) const {
  Stored stored;
  for (std::size_t v = 0; v < vertices_.size(); ++v) {
    if (!vertices_[v].locked && rings_.degree(static_cast<LocalVertex>(v)) == 0) continue;
    place[v] = static_cast<std::int32_t>(stored.vertices);
    vertices[stored.vertices++] = vertices_[v];
  }
  for (std::size_t v = 0; v < vertices_.size(); ++v) {
    for (const auto [a, b] : rings_.of(static_cast<LocalVertex>(v))) {
      if (v > a || v > b) continue;  // each triangle once, at its lowest vertex
      triangles[stored.triangles++] = {static_cast<LocalVertex>(place[v]), static_cast<LocalVertex>(place[a]),
                                       static_cast<LocalVertex>(place[b])};
    }
  }
  return stored;
}

}  // namespace geosis
