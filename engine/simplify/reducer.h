#pragma once

#include <cstdint>
#include <memory>

#include "engine/mesh/lod_hierarchy.h"
#include "engine/simplify/pass.h"
#include "engine/simplify/watch.h"
#include "engine/simplify/window.h"
#include "engine/simplify/window_sizes.h"
#include "engine/simplify/working_mesh.h"

namespace geosis {

/// Takes a mesh down from level to level: by passes over many windows while it is large, then as one window.
class Reducer {
 public:
  Reducer(WorkingMesh mesh, const WindowSizes& sizes, int threads, Watch& watch);

  /// Removes triangles until about `target` are left, or as many as can go. False if cancelled.
  bool reduce(std::int64_t target);

  std::int64_t triangles() const;
  double max_cost() const;                     ///< of the collapses so far
  bool at_floor() const { return at_floor_; }  ///< fewer triangles were asked for and could not be had
  LodLevel snapshot() const;                   ///< mesh and origins

 private:
  bool fits(std::int32_t size) const;
  bool reduce_by_passes(std::int64_t target);
  PassOptions plan_pass(std::int64_t target, bool first, bool stuck) const;
  void load_whole();

  WorkingMesh mesh_;
  const WindowSizes sizes_;
  const int threads_;
  Watch& watch_;
  std::uint32_t passes_ = 0;
  bool at_floor_ = false;
  std::unique_ptr<Window> whole_;  // holds the mesh from the moment it fits; mesh_ is then what was loaded
};

}  // namespace geosis
