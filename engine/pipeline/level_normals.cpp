#include "engine/pipeline/level_normals.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/volume/sample_at.h"

namespace geosis {
namespace {

constexpr double kLeastCosine = 0.8;

/// Mean direction of the triangles around each vertex, weighted by area; not of unit length.
std::vector<Vec3d> sums_of_normals(const IndexedMesh& mesh) {
  std::vector<Vec3d> normals(mesh.positions.size());
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3d p = to_double(mesh.positions[a]);
    const Vec3d normal = cross(to_double(mesh.positions[b]) - p, to_double(mesh.positions[c]) - p);
    for (const std::int32_t v : {a, b, c}) normals[v] = normals[v] + normal;
  }
  return normals;
}

/// The positions moved along the axis, as far as the volume goes.
std::vector<Vec3f> moved(const std::vector<Vec3f>& positions, GridIndex first, int axis, float step, float last) {
  const Vec3f back = {static_cast<float>(first.i), static_cast<float>(first.j), static_cast<float>(first.k)};
  std::vector<Vec3f> result = positions;
  for (Vec3f& p : result) {
    p = p - back;
    p[axis] = std::clamp(p[axis] + step, 0.0f, last);
  }
  return result;
}

/// One component of the gradient at each position; NaN where a sample that counts is missing.
Result<std::vector<double>> slopes(const IndexedMesh& mesh, const BrickedVolume& samples, GridIndex first, int axis,
                                   int threads, const Progress& progress) {
  const auto last = static_cast<float>(samples.shape()[axis] - 1);
  const std::vector<Vec3f> before = moved(mesh.positions, first, axis, -1, last),
                           after = moved(mesh.positions, first, axis, 1, last);
  const auto low = sample_at(samples, before, threads, progress);
  if (!low) return low.error();
  const auto high = sample_at(samples, after, threads, progress);
  if (!high) return high.error();
  std::vector<double> result(mesh.positions.size());
  for (std::size_t v = 0; v < result.size(); ++v) {
    const double distance = static_cast<double>(after[v][axis]) - before[v][axis];
    result[v] = (static_cast<double>((*high)[v]) - (*low)[v]) / distance;
  }
  return result;
}

/// Unit vector; along the sample axis when there is no direction at all.
Vec3f unit(Vec3d v) {
  const double length = norm(v);
  if (!(length > 0)) return {0, 0, 1};
  return {static_cast<float>(v.x / length), static_cast<float>(v.y / length), static_cast<float>(v.z / length)};
}

/// Scaled so that squares neither overflow nor vanish; the direction counts.
Vec3d scaled(Vec3d v) {
  const double largest = std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)});
  return largest > 0 && std::isfinite(largest) ? v * (1 / largest) : Vec3d{};
}

Vec3f choose(Vec3d gradient, Vec3d of_triangles) {
  gradient = scaled(gradient);
  const double projection = dot(gradient, of_triangles);
  const double product = norm(gradient) * norm(of_triangles);
  if (!(std::fabs(projection) >= kLeastCosine * product) || !(product > 0)) return unit(of_triangles);
  return unit(projection < 0 ? gradient * -1.0 : gradient);
}

}  // namespace

std::vector<Vec3f> normals_of_triangles(const IndexedMesh& mesh) {
  std::vector<Vec3f> normals;
  normals.reserve(mesh.positions.size());
  for (const Vec3d& sum : sums_of_normals(mesh)) normals.push_back(unit(sum));
  return normals;
}

Result<std::vector<Vec3f>> normals_of(const IndexedMesh& mesh, const BrickedVolume& samples, GridIndex first,
                                      bool mirrored, int threads, const Progress& progress) {
  std::vector<Vec3d> gradient(mesh.positions.size());
  for (int axis = 0; axis < 3; ++axis) {
    const auto slope = slopes(mesh, samples, first, axis, threads, progress);
    if (!slope) return slope.error();
    for (std::size_t v = 0; v < gradient.size(); ++v) gradient[v][axis] = (*slope)[v];
  }
  const std::vector<Vec3d> of_triangles = sums_of_normals(mesh);
  std::vector<Vec3f> normals(gradient.size());
  for (std::size_t v = 0; v < normals.size(); ++v) {
    normals[v] = choose(gradient[v], of_triangles[v] * (mirrored ? -1.0 : 1.0));
  }
  return normals;
}

}  // namespace geosis
