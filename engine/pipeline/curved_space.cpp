#include "engine/pipeline/curved_space.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <utility>

#include "engine/base/parallel.h"
#include "engine/isosurface/renumber_bodies.h"
#include "engine/isosurface/select_bodies.h"
#include "engine/mesh/empty_edges.h"
#include "engine/pipeline/output_space.h"

namespace geosis {
namespace {

constexpr std::int64_t kMostEdges = 20'000;  // of an axis that are looked at for their median
constexpr double kFarthest = 131'071;        // units from the origin that the lattice reaches
constexpr std::size_t kVerticesATask = 8192;

/// Of an axis, from edges at equal distances over the grid.
double median_edge(const GridGeometry& geometry, GridShape shape, int axis, double vertical_scale) {
  GridShape edges = shape;
  (axis == 0 ? edges.inlines : axis == 1 ? edges.crosslines : edges.samples) -= 1;
  const std::int64_t step = std::max<std::int64_t>(edges.count() / kMostEdges, 1);
  std::vector<double> lengths;
  for (std::int64_t n = 0; n < edges.count(); n += step) {
    const std::int64_t row = n / edges.samples;
    Vec3d at = {static_cast<double>(row / edges.crosslines), static_cast<double>(row % edges.crosslines),
                static_cast<double>(n % edges.samples)};
    const Vec3d from = geometry.map(at);
    at[axis] += 1;
    Vec3d edge = geometry.map(at) - from;
    edge.z *= vertical_scale;
    lengths.push_back(norm(edge));
  }
  if (lengths.empty()) return std::numeric_limits<double>::infinity();
  const auto middle = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2);
  std::nth_element(lengths.begin(), middle, lengths.end());
  return *middle;
}

/// The largest power of two that is not above the smallest axis's median edge; 1 when all edges are empty.
double choose_unit(const GridGeometry& geometry, GridShape shape, double vertical_scale) {
  double least = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    const double edge = median_edge(geometry, shape, axis, vertical_scale);
    if (edge > 0) least = std::min(least, edge);
  }
  return std::isfinite(least) ? std::exp2(std::floor(std::log2(least))) : 1;
}

/// The vertices' positions in the world.
std::vector<Vec3d> world_positions(const GridGeometry& geometry, double vertical_scale,
                                   const std::vector<Vec3f>& positions, int threads) {
  std::vector<Vec3d> world(positions.size());
  parallel_for((positions.size() + kVerticesATask - 1) / kVerticesATask, threads, [&](std::size_t task) {
    const std::size_t end = std::min((task + 1) * kVerticesATask, positions.size());
    for (std::size_t v = task * kVerticesATask; v < end; ++v) {
      world[v] = geometry.map(to_double(positions[v]));
      world[v].z *= vertical_scale;
    }
  });
  return world;
}

float on_lattice(double units) {
  return static_cast<float>(std::round(units * kLatticeStepsPerVoxel) / kLatticeStepsPerVoxel);
}

/// Entries of the vertices that stay.
template <class T>
void keep(std::vector<T>& of_vertex, const std::vector<std::int32_t>& index, std::size_t kept) {
  if (of_vertex.empty()) return;
  for (std::size_t v = 0; v < index.size(); ++v) {
    if (index[v] >= 0) of_vertex[static_cast<std::size_t>(index[v])] = of_vertex[v];
  }
  of_vertex.resize(kept);
}

/// The largest bodies, which have the first numbers, with the places of their vertices.
void keep_largest(LabelledSurface& surface, std::uint32_t largest, std::vector<Vec3f>& places) {
  if (surface.samples.size() <= largest) return;
  std::size_t kept = 0;
  for (std::size_t v = 0; v < places.size(); ++v) {
    if (surface.body[v] < largest) places[kept++] = places[v];
  }
  places.resize(kept);
  select_bodies(surface, {.largest = largest});
}

}  // namespace

Result<CurvedSpace> bend_surface(const GridGeometry& geometry, GridShape shape, const ReconstructOptions& options,
                                 const Progress& progress, LabelledSurface& surface) {
  const double vertical_scale = vertical_scale_of(options);
  const double unit = choose_unit(geometry, shape, vertical_scale);
  std::vector<Vec3f>& positions = surface.mesh.positions;
  const std::vector<Vec3d> world = world_positions(geometry, vertical_scale, positions, options.threads);
  Vec3d low = world.front(), high = world.front();
  for (const Vec3d& p : world) {
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], p[axis]);
      high[axis] = std::max(high[axis], p[axis]);
    }
  }
  CurvedSpace curved;
  Vec3d origin;
  for (int axis = 0; axis < 3; ++axis) {
    origin[axis] = std::floor(low[axis] / unit) * unit;
    if ((high[axis] - origin[axis]) / unit < kFarthest) continue;
    return Error{ErrorCode::limit_exceeded, "the surface is " + std::to_string((high[axis] - origin[axis]) / unit) +
                                                " cell edges long; at most " + std::to_string(kFarthest)};
  }
  curved.space = AffineGeometry(origin, {unit, 0, 0}, {0, unit, 0}, {0, 0, unit});
  curved.places = positions;
  for (std::size_t v = 0; v < world.size(); ++v) {
    const Vec3d units = (world[v] - origin) * (1 / unit);
    positions[v] = {on_lattice(units.x), on_lattice(units.y), on_lattice(units.z)};
  }
  const auto index = collapse_empty_edges(surface.mesh, progress);
  if (!index) return index.error();
  keep(surface.body, *index, positions.size());
  keep(curved.places, *index, positions.size());
  renumber_bodies(surface, options.cap, false);
  if (options.bodies.largest) keep_largest(surface, *options.bodies.largest, curved.places);
  return curved;
}

}  // namespace geosis
