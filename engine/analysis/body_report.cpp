#include "engine/analysis/body_report.h"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <string>

#include "engine/mesh/components.h"
#include "engine/mesh/corner_table.h"

namespace geosis {
namespace {

constexpr std::int32_t kNone = -1;

Result<void> check_labels(const IndexedMesh& mesh, std::span<const std::uint32_t> body, std::size_t bodies,
                          std::span<const std::uint8_t> reliability) {
  const std::size_t vertices = mesh.positions.size();
  if (body.size() != vertices || (!reliability.empty() && reliability.size() != vertices)) {
    return Error{ErrorCode::invalid_argument, "bodies: " + std::to_string(body.size()) + " labels and " +
                                                  std::to_string(reliability.size()) + " reliabilities for " +
                                                  std::to_string(vertices) + " vertices"};
  }
  for (std::size_t v = 0; v < vertices; ++v) {
    if (body[v] < bodies) continue;
    return Error{ErrorCode::invalid_argument, "bodies: vertex " + std::to_string(v) + " is labelled " +
                                                  std::to_string(body[v]) + ", there are " + std::to_string(bodies)};
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& [p, q, r] = mesh.triangles[t];
    if (body[p] == body[q] && body[q] == body[r]) continue;
    return Error{ErrorCode::invalid_argument, "bodies: triangle " + std::to_string(t) + " has vertices of two"};
  }
  return {};
}

/// Six times the volume that triangles enclose, in lattice steps: summed from the projections along the sample axis,
/// modulo 2^64, so that the total of a closed surface is exact in any order.
std::uint64_t six_lattice_volumes(const IndexedMesh& mesh, const Triangle& t) {
  std::array<std::array<std::int64_t, 3>, 3> at{};
  for (int n = 0; n < 3; ++n) {
    for (int axis = 0; axis < 3; ++axis) {
      at[n][axis] = static_cast<std::int64_t>(mesh.positions[t[n]][axis] * float{kLatticeStepsPerVoxel});
    }
  }
  const auto& [a, b, c] = at;
  const std::int64_t twice_area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
  return static_cast<std::uint64_t>((a[2] + b[2] + c[2]) * twice_area);
}

double to_voxels(std::uint64_t six_volumes) {
  constexpr double kSixCubes = 6.0 * kLatticeStepsPerVoxel * kLatticeStepsPerVoxel * kLatticeStepsPerVoxel;
  return static_cast<double>(std::bit_cast<std::int64_t>(six_volumes)) / kSixCubes;
}

/// World positions as differences to that of the body's first vertex.
struct RelativePositions {
  std::vector<Vec3d> origin;    ///< [body], of its first vertex
  std::vector<Vec3d> position;  ///< [vertex]
};

/// An affine map is applied to the difference of the indices, which is exact.
Vec3d map_difference(const GridGeometry& geometry, Vec3d index, Vec3d first, Vec3d mapped_first) {
  const std::array<double, 16>* m = geometry.affine();
  if (m == nullptr) return geometry.map(index) - mapped_first;
  const Vec3d d = index - first;
  const auto row = [&](int n) { return (*m)[n] * d.x + (*m)[n + 1] * d.y + (*m)[n + 2] * d.z; };
  return {row(0), row(4), row(8)};
}

RelativePositions map_relative(const IndexedMesh& mesh, std::span<const std::uint32_t> body, std::size_t bodies,
                               const GridGeometry& geometry) {
  RelativePositions relative{std::vector<Vec3d>(bodies), {}};
  relative.position.reserve(mesh.positions.size());
  std::vector<std::int32_t> first(bodies, kNone);
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    std::int32_t& first_vertex = first[body[v]];
    if (first_vertex == kNone) {
      first_vertex = static_cast<std::int32_t>(v);
      relative.origin[body[v]] = geometry.map(to_double(mesh.positions[v]));
    }
    relative.position.push_back(map_difference(geometry, to_double(mesh.positions[v]),
                                               to_double(mesh.positions[first_vertex]), relative.origin[body[v]]));
  }
  return relative;
}

/// Sums over the triangles of one body; tetrahedra stand on its first vertex.
struct BodySums {
  double twice_area = 0, six_volumes = 0;
  Vec3d moment;  ///< of the tetrahedra: 24 times volume times centroid
  Vec3d vertices;
  std::uint64_t six_lattice_volumes = 0;
  std::int64_t interpolated = 0;

  void add_triangle(Vec3d a, Vec3d b, Vec3d c) {
    const Vec3d normal = cross(b - a, c - a);
    const double six_volume = dot(a, normal);
    twice_area += norm(normal);
    six_volumes += six_volume;
    moment = moment + (a + b + c) * six_volume;
  }

  /// Relative to the first vertex.
  Vec3d centroid(std::int64_t count) const {
    if (six_lattice_volumes == 0 || six_volumes == 0) return vertices * (1.0 / static_cast<double>(count));
    return moment * (0.25 / six_volumes);
  }
};

void grow(BodyReport& report, Vec3d p) {
  for (int axis = 0; axis < 3; ++axis) {
    if (report.vertices == 0 || p[axis] < report.low[axis]) report.low[axis] = p[axis];
    if (report.vertices == 0 || p[axis] > report.high[axis]) report.high[axis] = p[axis];
  }
}

/// What adds up over vertices and triangles.
void measure(const IndexedMesh& mesh, std::span<const std::uint32_t> body, const GridGeometry& geometry,
             std::span<const std::uint8_t> reliability, std::vector<BodyReport>& reports) {
  const auto [origin, position] = map_relative(mesh, body, reports.size(), geometry);
  std::vector<BodySums> sums(reports.size());
  for (std::size_t v = 0; v < body.size(); ++v) {
    BodySums& sum = sums[body[v]];
    grow(reports[body[v]], geometry.map(to_double(mesh.positions[v])));
    ++reports[body[v]].vertices;
    sum.vertices = sum.vertices + position[v];
    sum.interpolated += !reliability.empty() && reliability[v] < std::numeric_limits<std::uint8_t>::max();
  }
  for (const Triangle& t : mesh.triangles) {
    BodySums& sum = sums[body[t[0]]];
    sum.add_triangle(position[t[0]], position[t[1]], position[t[2]]);
    sum.six_lattice_volumes += six_lattice_volumes(mesh, t);
    ++reports[body[t[0]]].triangles;
  }
  for (std::size_t b = 0; b < reports.size(); ++b) {
    BodyReport& report = reports[b];
    const BodySums& sum = sums[b];
    if (report.vertices == 0) continue;
    report.volume = sum.six_volumes / 6;
    report.area = sum.twice_area / 2;
    report.volume_voxels = to_voxels(geometry.mirrored() ? -sum.six_lattice_volumes : sum.six_lattice_volumes);
    report.centroid = origin[b] + sum.centroid(report.vertices);
    report.interpolated_share = static_cast<double>(sum.interpolated) / static_cast<double>(report.vertices);
  }
}

/// Surfaces, cavities and genus.
void count_surfaces(const IndexedMesh& mesh, std::span<const std::uint32_t> body, bool mirrored,
                    const CornerTable& table, std::vector<BodyReport>& reports) {
  const Components surfaces = find_components(mesh);
  std::vector<std::uint64_t> six_volumes(static_cast<std::size_t>(surfaces.count), 0);
  for (const Triangle& t : mesh.triangles) six_volumes[surfaces.of_vertex[t[0]]] += six_lattice_volumes(mesh, t);
  std::vector<std::uint32_t> body_of(six_volumes.size(), 0);
  for (std::size_t v = 0; v < body.size(); ++v) {
    if (surfaces.of_vertex[v] != Components::kUnused) body_of[surfaces.of_vertex[v]] = body[v];
  }
  const std::vector<ComponentTopology> topology = measure_components(surfaces, table);
  for (std::size_t n = 0; n < topology.size(); ++n) {
    BodyReport& report = reports[body_of[n]];
    ++report.components;
    report.genus += topology[n].genus();
    const double volume = to_voxels(mirrored ? -six_volumes[n] : six_volumes[n]);
    report.cavities += topology[n].boundary_loops == 0 && volume < 0;
  }
}

}  // namespace

Result<std::vector<BodyReport>> report_bodies(const IndexedMesh& mesh, std::span<const std::uint32_t> body,
                                              std::size_t bodies, const GridGeometry& geometry,
                                              std::span<const std::uint8_t> reliability) {
  const auto table = build_corner_table(mesh);
  if (!table) return table.error();
  if (auto checked = check_labels(mesh, body, bodies, reliability); !checked) return std::move(checked).error();
  std::vector<BodyReport> reports(bodies);
  measure(mesh, body, geometry, reliability, reports);
  count_surfaces(mesh, body, geometry.mirrored(), *table, reports);
  return reports;
}

}  // namespace geosis
