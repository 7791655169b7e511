#include "engine/simplify/window.h"

#include <cassert>
#include <utility>

#include "engine/simplify/first_star.h"
#include "engine/simplify/reduce_window.h"

namespace geosis {

void Window::load(std::vector<WorkingVertex> vertices, std::span<const LocalTriangle> triangles, const Box& bounds) {
  assert(vertices.size() <= kMaxVertices);
  state_.vertices = std::move(vertices);
  state_.bounds = bounds;
  state_.triangles = static_cast<std::int64_t>(triangles.size());
  state_.max_cost = 0;
  state_.queued = false;
  state_.rings.build(state_.vertices.size(), triangles);
  state_.version.assign(state_.vertices.size(), 0);
  state_.marks.reset(state_.vertices.size());
}

bool Window::start(std::span<const LocalTriangle> triangles) {
  for (const auto& [a, b, c] : triangles)
    add_triangle_plane(state_.vertices[a], state_.vertices[b], state_.vertices[c]);
  const auto position = [&](LocalVertex v) { return state_.vertices[v].position; };
  ClosedFans closed(state_.vertices.size());
  for (std::size_t i = 0; i < state_.vertices.size(); ++i) {
    const auto v = static_cast<LocalVertex>(i);
    if (state_.vertices[v].locked || closed.is_closed_fan(v, state_.rings.of(v))) continue;
    const Fan<RingTriangle> fan(v, state_.rings.of(v));
    if (!fan.is_sound()) return false;
    if (fan.is_open()) add_boundary_planes(state_.vertices[v], fan, position);
  }
  return true;
}

bool Window::reduce(const Goal& goal, const Rules& rules, Watch& watch) {
  state_.capped = false;
  return reduce_window(state_, goal, rules, watch);
}

Window::Stored Window::store(std::span<WorkingVertex> vertices, std::span<LocalTriangle> triangles,
                             std::span<std::int32_t> place) const {
  Stored stored;
  for (std::size_t v = 0; v < state_.vertices.size(); ++v) {
    if (!state_.vertices[v].locked && state_.rings.degree(static_cast<LocalVertex>(v)) == 0) continue;
    place[v] = static_cast<std::int32_t>(stored.vertices);
    vertices[stored.vertices++] = state_.vertices[v];
  }
  // Each triangle once, at its lowest vertex, without a branch that could go either way.
  const auto all = static_cast<std::size_t>(state_.triangles);
  for (std::size_t v = 0; v < state_.vertices.size(); ++v) {
    for (const auto [a, b] : state_.rings.of(static_cast<LocalVertex>(v))) {
      if (stored.triangles == all) return stored;
      triangles[stored.triangles] = {static_cast<LocalVertex>(place[v]), static_cast<LocalVertex>(place[a]),
                                     static_cast<LocalVertex>(place[b])};
      stored.triangles += static_cast<std::size_t>((v < a) & (v < b));
    }
  }
  return stored;
}

}  // namespace geosis
