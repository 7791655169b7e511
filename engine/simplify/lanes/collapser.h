// The inner loop of simplification; see lanes.h.
#if defined(GEOSIS_SIMPLIFY_LANES_COLLAPSER_H) == defined(HWY_TARGET_TOGGLE)
#ifdef GEOSIS_SIMPLIFY_LANES_COLLAPSER_H
#undef GEOSIS_SIMPLIFY_LANES_COLLAPSER_H
#else
#define GEOSIS_SIMPLIFY_LANES_COLLAPSER_H
#endif

#include <bit>
#include <limits>
#include <utility>

#include "engine/simplify/lanes/edge_cost.h"
#include "engine/simplify/lanes/fold_check.h"
#include "engine/simplify/lanes/merge_rings.h"
#include "engine/simplify/lanes/star_shape.h"
#include "engine/simplify/random_edges.h"
#include "engine/simplify/rules.h"
#include "engine/simplify/watch.h"
#include "engine/simplify/window_state.h"

HWY_BEFORE_NAMESPACE();
namespace geosis {
namespace HWY_NAMESPACE {

/// Share of a merged quadric that is replaced by the planes of the present triangles. Half the memory gives less error
/// than all of it, and fewer vanishing ends of thin bodies than none.
inline constexpr float kFreshShare = 0.5f;

/// After a collapse only edges up to this multiple of the cheapest one around are worth queueing: fewer in a pass that
/// others follow, every edge once few triangles are left, where the next best choice can be a bad one.
inline constexpr float kQueueLimit = 2.0f;
inline constexpr float kQueueLimitInPass = 1.5f;
inline constexpr std::int64_t kFewTriangles = 8192;

inline constexpr int kChoices = 8;          // edges to choose from: the paper's Table 1
inline constexpr int kMostRefusals = 1000;  // in a row; what is left then will hardly collapse

inline constexpr std::int64_t kTrianglesBetweenReports = 8192;

class Collapser {
 public:
  Collapser(WindowState& window, const Goal& goal, const Rules& rules, Watch& watch)
      : w_(window), vertices_(window.vertices.data()), goal_(goal), rules_(rules), watch_(watch) {}

  bool reduce() { return rules_.strategy == Strategy::greedy ? reduce_greedily() : reduce_by_multiple_choice(); }

 private:
  bool reduce_greedily() {
    if (!std::exchange(w_.queued, true)) queue_all_edges();
    while (w_.triangles > goal_.triangles) {
      const std::int64_t before = w_.triangles;
      if (!collapse_cheapest_first()) return false;
      if (w_.triangles <= goal_.triangles) break;
      // The queue ran empty. What was refused or not worth queueing gets another chance, as long as that leads
      // anywhere.
      queue_all_edges();
      if (before - w_.triangles <= before / 1000) break;
    }
    return true;
  }

  bool is_free(LocalVertex u) const { return !vertices_[u].locked && w_.rings.degree(u) <= kMaxDegree; }

  /// Edges on their way to the queue.
  struct Batch {
    static constexpr int kSize = 128;
    LocalVertex u[kSize + kMaxDegree + 1], v[kSize + kMaxDegree + 1];
    int count = 0;
  };

  /// Fills the queue with every edge of the window.
  void queue_all_edges() {
    w_.queue.clear();
    w_.queue.reserve(3 * w_.vertices.size());
    Batch batch;
    for (std::size_t i = 0; i < w_.vertices.size(); ++i) {
      const auto u = static_cast<LocalVertex>(i);
      if (!is_free(u)) continue;
      if (vertices_[u].on_boundary) {
        const Neighbours around = neighbours_of(u, true, w_.rings);
        for (const LocalVertex v : around) add_edge(batch, u, v);
      } else {
        for (const RingTriangle t : w_.rings.of(u)) add_edge(batch, u, t.a);
      }
      if (batch.count >= Batch::kSize) queue_batch(batch, batch.count / kLanes * kLanes);
    }
    queue_batch(batch, batch.count);
  }

  /// Each edge once. Without a branch: which way it would go is anybody's guess.
  HWY_INLINE void add_edge(Batch& batch, LocalVertex u, LocalVertex v) const {
    batch.u[batch.count] = u;
    batch.v[batch.count] = v;
    batch.count += static_cast<int>(v > u) & static_cast<int>(!vertices_[v].locked);
  }

  /// Queues the first `count` edges and keeps the others.
  void queue_batch(Batch& batch, int count) {
    for (int first = 0; first < count; first += kLanes) {
      const int size = std::min(kLanes, count - first);
      float costs[kLanes];
      cost_of(batch.u + first, batch.v + first, size, costs);
      for (int k = 0; k < size; ++k) push(batch.u[first + k], batch.v[first + k], costs[k]);
    }
    for (int k = count; k < batch.count; ++k) {
      batch.u[k - count] = batch.u[k];
      batch.v[k - count] = batch.v[k];
    }
    batch.count -= count;
  }

  /// Of up to eight edges; what lies behind is anything.
  void cost_of(const LocalVertex* from, const LocalVertex* to, int count, float (&costs)[kLanes]) const {
    const WorkingVertex *u[kLanes], *v[kLanes];
    for (int k = 0; k < kLanes; ++k) {
      const int filled = k < count ? k : 0;
      u[k] = &vertices_[from[filled]];
      v[k] = &vertices_[to[filled]];
    }
    edge_costs(u, v, costs, rules_.placement);
  }

  void queue_edges_around(LocalVertex u) {
    if (!is_free(u)) return;
    const Neighbours around =
        neighbours_of(u, vertices_[u].on_boundary, w_.rings, [&](LocalVertex v) { return !vertices_[v].locked; });
    if (around.count == 0) return;
    float costs[(kMaxDegree + kLanes) / kLanes * kLanes];
    float least = std::numeric_limits<float>::max();
    for (int first = 0; first < around.count; first += kLanes) {
      const WorkingVertex* v[kLanes];
      for (int k = 0; k < kLanes; ++k) v[k] = &vertices_[around.ids[std::min(first + k, around.count - 1)]];
      edge_costs(vertices_[u], v, costs + first, rules_.placement);
      least = std::min(least, *std::min_element(costs + first, costs + first + kLanes));  // what is filled up repeats
    }
    const Float8 limit = all8(queue_limit(least));
    for (int first = 0; first < around.count; first += kLanes) {
      Float8 group;
      std::memcpy(&group, costs + first, sizeof(group));
      std::uint32_t wanted = bits_of((group <= limit) & lanes_below(first, around.count));
      for (; wanted != 0; wanted &= wanted - 1) {
        const int k = first + std::countr_zero(wanted);
        push(u, around.ids[k], costs[k]);
      }
    }
  }

  float queue_limit(float least) const {
    if (goal_.is_followed) return kQueueLimitInPass * least;
    return w_.triangles < kFewTriangles ? std::numeric_limits<float>::max() : kQueueLimit * least;
  }

  HWY_INLINE void push(LocalVertex u, LocalVertex v, float cost) {
    w_.queue.push({u, v, w_.version[u], w_.version[v]}, cost);
  }

  HWY_INLINE bool is_current(const QueuedEdge& edge) const {
    return w_.version[edge.u] == edge.version_u && w_.version[edge.v] == edge.version_v;
  }

  /// Has what the edge's collapse will look at first fetched into the cache.
  HWY_INLINE void prefetch(const QueuedEdge& edge) const {
    if (!is_current(edge)) return;
    for (const LocalVertex v : {edge.u, edge.v}) {
      __builtin_prefetch(&vertices_[v]);
      w_.rings.prefetch(v);
    }
  }

  bool collapse_cheapest_first() {
    std::int64_t reported = w_.triangles;
    QueuedEdge edge;
    while (w_.triangles > goal_.triangles && w_.queue.pop(edge)) {
      if (const QueuedEdge* next = w_.queue.likely_next()) prefetch(*next);
      if (!is_current(edge)) continue;
      if (!try_collapse(edge.u, edge.v)) continue;
      queue_edges_around(edge.u);
      if (reported - w_.triangles < kTrianglesBetweenReports) continue;
      if (!watch_.removed(reported - w_.triangles)) return false;
      reported = w_.triangles;
    }
    return watch_.removed(reported - w_.triangles);
  }

  /// The paper's rule: of 8 random edges the cheapest collapses, whatever the others of the window cost.
  bool reduce_by_multiple_choice() {
    RandomEdges random(rules_.seed);
    for (std::size_t v = 0; v < w_.vertices.size(); ++v) {
      if (!vertices_[v].locked) random.add(static_cast<LocalVertex>(v));
    }
    std::int64_t reported = w_.triangles;
    for (int refused = 0; w_.triangles > goal_.triangles && refused < kMostRefusals;) {
      const QueuedEdge edge = cheapest_of_random(random);
      refused = edge.u != edge.v && try_collapse(edge.u, edge.v) ? 0 : refused + 1;
      if (reported - w_.triangles < kTrianglesBetweenReports) continue;
      if (!watch_.removed(reported - w_.triangles)) return false;
      reported = w_.triangles;
    }
    return watch_.removed(reported - w_.triangles);
  }

  /// u == v when none was found.
  QueuedEdge cheapest_of_random(RandomEdges& random) {
    static_assert(kChoices == kLanes);
    LocalVertex us[kLanes], vs[kLanes];
    int count = 0;
    for (int i = 0; i < kChoices; ++i) {
      LocalVertex u, v;
      if (!random.draw(w_.rings, u, v)) break;
      if (!is_free(u) || !is_free(v)) continue;
      us[count] = u;
      vs[count++] = v;
    }
    if (count == 0) return {};
    float costs[kLanes];
    cost_of(us, vs, count, costs);
    const float* least = std::min_element(costs, costs + count);
    return {us[least - costs], vs[least - costs], 0, 0};
  }

  /// weight    of the planes whose squared distances the cost sums up: an area.
  bool within_goal(float cost, float weight) {
    const bool within = !(cost > goal_.max_cost || cost > goal_.max_error * goal_.max_error * weight);
    w_.capped = w_.capped || !within;
    return within;
  }

  /// Merges v into u, if that keeps topology and shape.
  bool try_collapse(LocalVertex u, LocalVertex v) {
    if (!find_merged_star(u, v, w_, w_.marks, star_)) return false;
    for (const RingTriangle t : star_.triangles()) {
      __builtin_prefetch(&vertices_[t.a]);
      w_.rings.prefetch(t.a);
    }
    WorkingVertex& kept = vertices_[u];
    const WorkingVertex& gone = vertices_[v];
    const Vec3f edge = gone.position - kept.position;
    const Quadric sum = kept.quadric() + seen_from(gone.quadric(), edge);
    Vec3f place = best_point(sum, edge, merge_target(kept, gone), rules_.placement);
    const bool on_boundary = kept.on_boundary || gone.on_boundary;
    measure_star(star_, u, v, vertices_, shape_);
    if (!on_boundary && rules_.placement == Placement::optimal) place = keep_volume(shape_, edge, place);
    const Vec3f position = snap_to_lattice(kept.position + place, w_.bounds);
    move_star(star_, shape_, position, !on_boundary, moved_);
    if (!moved_.sound) return false;
    Quadric merged = seen_from(sum, kept.position - position);
    merged.c = merged.c > 0 ? merged.c : 0;
    if (!within_goal(merged.c, merged.trace())) return false;
    if (goal_.refuse_folds && moved_.sharp &&
        folds_over(star_, shape_, moved_, u, v, position, !on_boundary, vertices_, w_.rings, w_.marks))
      return false;

    if (merged.c > w_.max_cost) w_.max_cost = merged.c;
    // The planes that hold a boundary would fade away with the memory.
    kept.set_quadric(on_boundary ? merged : blend(merged, moved_.planes, kFreshShare));
    if (nearer(position, gone.position, kept.position)) kept.origin = gone.origin;
    kept.position = position;
    kept.on_boundary = on_boundary;
    commit(u, v);
    return true;
  }

  static bool nearer(Vec3f place, Vec3f p, Vec3f q) { return dot(p - place, p - place) < dot(q - place, q - place); }

  void commit(LocalVertex u, LocalVertex v) {
    merge_rings(w_.rings, u, v, vertices_[v].on_boundary, star_);
    w_.triangles -= star_.shared;
    ++w_.version[u];
    ++w_.version[v];
  }

  WindowState& w_;
  WorkingVertex* const vertices_;
  const Goal& goal_;
  const Rules& rules_;
  Watch& watch_;
  MergedStar star_;
  StarShape shape_;
  MovedStar moved_;
};

}  // namespace HWY_NAMESPACE
}  // namespace geosis
HWY_AFTER_NAMESPACE();

#endif
