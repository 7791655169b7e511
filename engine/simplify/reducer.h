#pragma once

#include <cstdint>
#include <functional>
#include <memory>

#include "engine/mesh/lod_hierarchy.h"
#include "engine/simplify/pass.h"
#include "engine/simplify/rules.h"
#include "engine/simplify/watch.h"
#include "engine/simplify/window.h"
#include "engine/simplify/window_sizes.h"
#include "engine/simplify/working_mesh.h"

namespace geosis {

struct ReducerOptions {
  Rules rules;
  WindowSizes sizes;
  int threads = 1;
};

/// Takes a mesh down from level to level: by passes over many windows while it is large, then as one window.
class Reducer {
 public:
  /// m0   must stay as it is while the reducer is used.
  Reducer(const IndexedMesh& m0, const ReducerOptions& options, Watch& watch);

  /// A copy goes its own way.
  Reducer(const Reducer& other);
  Reducer& operator=(Reducer&&) = default;

  /// Removes triangles until about goal.triangles are left, or as many as can go. Unless done, it is of no more use.
  PassEnd reduce(const Goal& goal);

  /// Takes out the vertices, and their triangles, for whose vertex of M0 `goes` holds: whole components.
  PassEnd remove(const std::function<bool(std::int32_t origin)>& goes);

  std::int64_t triangles() const;
  double max_cost() const { return max_cost_; }         ///< of the collapses so far
  StoppedBy stopped_by() const { return stopped_by_; }  ///< the last goal
  LodLevel snapshot() const;                            ///< mesh and origins

 private:
  bool fits(std::int32_t size) const;
  PassEnd reduce_by_passes(const Goal& goal);
  PassOptions plan_pass(const Goal& goal, bool first, bool stuck) const;
  bool load_whole();
  WorkingMesh store_whole() const;

  WorkingMesh mesh_;
  ReducerOptions options_;
  Watch* watch_;
  std::uint32_t passes_ = 0;
  float max_cost_ = 0;
  bool capped_ = false;
  StoppedBy stopped_by_ = StoppedBy::none;
  std::unique_ptr<Window> whole_;  // holds the mesh from the moment it fits; mesh_ is then of no use
};

}  // namespace geosis
