#pragma once

#include <array>
#include <cstdint>
#include <set>
#include <vector>

#include "engine/base/vec3.h"
#include "engine/isosurface/extract.h"
#include "tests/support/grid_strata.h"
#include "tests/support/scalar_field.h"

namespace geosis::test {

/// The connected components of {low <= f <= high} in the domain, the domain's cells joined across faces only. Knows
/// nothing of meshes, case tables or runs.
class SolidOracle {
 public:
  SolidOracle(const ScalarField& field, IsoRange range, BodyMode mode);

  /// False: a saddle lies (nearly) on an end of the range, more than one answer is right.
  bool decided() const { return decided_; }
  std::int32_t bodies() const { return static_cast<std::int32_t>(voxels_.size()); }
  /// Nodes of each body; one where the domain touches itself counts for the body in its first cell.
  const std::vector<std::int64_t>& voxels() const { return voxels_; }
  /// Body of a node as its first cell sees it, -1 outside the solid.
  std::int32_t body_of(GridIndex node) const { return of_node_[static_cast<std::size_t>(index(node))]; }
  /// The bodies at a node or on the grid edge that the position lies on: more than one where the domain touches itself.
  std::set<std::int32_t> bodies_at(Vec3f position) const;

 private:
  std::int32_t index(GridIndex n) const { return (n.i * nodes_.crosslines + n.j) * nodes_.samples + n.k; }
  void join_cells(const ScalarField& field, IsoRange range, BodyMode mode);
  void place_nodes(const ScalarField& field, IsoRange range, BodyMode mode);

  GridShape nodes_;
  Domain domain_;
  bool decided_ = true;
  std::vector<std::array<std::int32_t, 12>> of_edge_;  // [cell, numbered by its first node]: first band, then body
  std::vector<std::int32_t> of_node_;
  std::vector<std::int64_t> voxels_;
};

}  // namespace geosis::test
