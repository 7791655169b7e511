#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/simplify/rules.h"
#include "engine/simplify/watch.h"
#include "engine/simplify/window_state.h"

namespace geosis {

/// A piece of the mesh small enough for the cache, simplified by itself.
///
///   load     vertices and triangles in, one-rings built
///   start    planes of M0's triangles, before anything has moved
///   reduce   collapse edges until the goal is reached; may be called again with a farther goal
///   store    what is left, out
///
/// Scratch of one thread: loading again reuses the memory.
class Window {
 public:
  static constexpr std::int32_t kMaxVertices = 65'536;

  /// vertices    at most kMaxVertices; all triangles of those that are not locked are given.
  /// bounds      no vertex leaves it.
  void load(std::vector<WorkingVertex> vertices, std::span<const LocalTriangle> triangles, const Box& bounds);

  /// Gives the vertices that are not locked what they start with; false if the triangles around one are not a fan.
  ///
  /// triangles   those that were loaded.
  bool start(std::span<const LocalTriangle> triangles);

  /// Collapses edges until the goal is reached or no edge can collapse. False if cancelled.
  bool reduce(const Goal& goal, const Rules& rules, Watch& watch);

  std::size_t vertices() const { return state_.vertices.size(); }  ///< loaded
  std::int64_t triangles() const { return state_.triangles; }
  float max_cost() const { return state_.max_cost; }  ///< of the collapses since load
  bool capped() const { return state_.capped; }  ///< whether the last goal's max_cost or max_error refused a collapse

  struct Stored {
    std::size_t vertices = 0, triangles = 0;
  };

  /// Writes locked vertices and those that still have triangles, in their order, and the triangles over them.
  ///
  /// place    (vertices loaded) gets each written vertex's index in `vertices`.
  /// The other spans need the room of what was loaded.
  Stored store(std::span<WorkingVertex> vertices, std::span<LocalTriangle> triangles,
               std::span<std::int32_t> place) const;

  /// Gives the vertices' memory back for the next load.
  std::vector<WorkingVertex> take_vertices() { return std::move(state_.vertices); }

 private:
  WindowState state_;
};

}  // namespace geosis
