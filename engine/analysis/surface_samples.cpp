#include "engine/analysis/surface_samples.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace geosis {
namespace {

double triangle_area(const IndexedMesh& mesh, const Triangle& triangle) {
  const Vec3d a = to_double(mesh.positions[triangle[0]]);
  const Vec3d b = to_double(mesh.positions[triangle[1]]);
  const Vec3d c = to_double(mesh.positions[triangle[2]]);
  return norm(cross(b - a, c - a)) / 2;
}

/// The s-th number of the golden ratio sequence in [0, 1): evenly spread, in any run of successive s too.
double golden_ratio_sequence(std::size_t s) {
  const auto turned = static_cast<std::uint32_t>(s * 2654435769u);  // 2^32 / golden ratio, modulo 2^32
  return turned / 4294967296.0;
}

/// The unit square folded onto the triangle so that equal areas stay equal.
Vec3d point_in_triangle(const IndexedMesh& mesh, const Triangle& triangle, double u, double v) {
  const double root = std::sqrt(u);
  const Vec3d a = to_double(mesh.positions[triangle[0]]);
  const Vec3d b = to_double(mesh.positions[triangle[1]]);
  const Vec3d c = to_double(mesh.positions[triangle[2]]);
  return a * (1 - root) + b * (root * (1 - v)) + c * (root * v);
}

void add_vertices(const IndexedMesh& mesh, std::size_t count, SurfaceSamples& samples) {
  for (std::size_t s = 0; s < count; ++s) {
    samples.points.push_back(to_double(mesh.positions[s * mesh.positions.size() / count]));
  }
  samples.vertices = count;
}

void add_points_by_area(const IndexedMesh& mesh, std::size_t count, SurfaceSamples& samples) {
  double total = 0;
  for (const Triangle& triangle : mesh.triangles) total += triangle_area(mesh, triangle);
  std::size_t t = 0;
  double before = 0, area = triangle_area(mesh, mesh.triangles[0]);
  for (std::size_t s = 0; s < count; ++s) {
    const double target = (static_cast<double>(s) + 0.5) / static_cast<double>(count) * total;
    while (before + area < target && t + 1 < mesh.triangles.size()) {
      before += area;
      area = triangle_area(mesh, mesh.triangles[++t]);
    }
    const double share = area > 0 ? std::clamp((target - before) / area, 0.0, 1.0) : 0;
    samples.points.push_back(point_in_triangle(mesh, mesh.triangles[t], share, golden_ratio_sequence(s)));
  }
}

}  // namespace

SurfaceSamples sample_surface(const IndexedMesh& mesh, std::size_t count) {
  SurfaceSamples samples;
  samples.points.reserve(count);
  add_vertices(mesh, std::min(count / 2, mesh.positions.size()), samples);
  add_points_by_area(mesh, count - samples.vertices, samples);
  return samples;
}

}  // namespace geosis
