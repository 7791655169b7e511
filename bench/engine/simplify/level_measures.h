#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bench/engine/simplify/bench_mesh.h"
#include "engine/analysis/surface_samples.h"
#include "engine/analysis/triangle_grid.h"
#include "engine/mesh/indexed_mesh.h"

namespace geosis {

/// Distances of points of one surface or curve to another, in voxels.
struct DistanceSpread {
  double mean = 0, p99 = 0, max = 0;
};

/// Both ways: from M0 to the level, and from the level to M0.
struct TwoWays {
  DistanceSpread away, back;
};

/// Intersecting pairs of triangles, by what they belong to.
struct IntersectingPairs {
  std::int64_t within_a_sheet = 0;      ///< one component, and one isovalue where the range has two
  std::int64_t between_sheets = 0;      ///< the two isovalues
  std::int64_t between_components = 0;  ///< of one isovalue

  std::int64_t all() const { return within_a_sheet + between_sheets + between_components; }
};

/// What is measured of a mesh.
struct LevelMeasures {
  std::int64_t triangles = 0, components = 0, euler = 0, genus = 0, boundary_loops = 0;
  std::string topology;  ///< "kept", or what differs from M0's
  TwoWays distance;
  std::optional<TwoWays> rim;  ///< of the boundary curves, where M0 has any
  double volume_drift = 0;     ///< share of M0's
  std::optional<IntersectingPairs> pairs;
};

/// M0 and what measuring against it needs.
class MeasuredAgainst {
 public:
  explicit MeasuredAgainst(const BenchMesh& mesh);

  /// origin   of each vertex in M0; empty = each is its own.
  /// pairs    whether to look for intersecting pairs: only of meshes on the lattice.
  LevelMeasures measure(const IndexedMesh& level, std::span<const std::int32_t> origin, bool pairs) const;

 private:
  IntersectingPairs find_pairs(const IndexedMesh& level, std::span<const std::int32_t> origin) const;

  struct Topology;
  static Topology topology_of(const IndexedMesh& mesh);
  std::string difference(const Topology& level) const;

  const BenchMesh& mesh_;
  std::shared_ptr<const Topology> topology_;
  SurfaceSamples samples_;
  TriangleGrid grid_;
  IndexedMesh rim_;  ///< each boundary edge as a triangle with two equal corners
  std::vector<Vec3d> rim_samples_;
  std::unique_ptr<TriangleGrid> rim_grid_;
  double volume_ = 0;
};

}  // namespace geosis
