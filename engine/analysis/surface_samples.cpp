#include "engine/analysis/surface_samples.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

#include "engine/base/stretches.h"

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

std::optional<double> total_area(const IndexedMesh& mesh, const Progress& progress) {
  double total = 0;
  Stretches stretches(mesh.triangles.size(), progress);
  while (stretches.next()) {
    for (std::size_t t = stretches.begin(); t < stretches.end(); ++t) total += triangle_area(mesh, mesh.triangles[t]);
  }
  if (stretches.are_cancelled()) return std::nullopt;
  return total;
}

/// The points of equal shares of an area, which lie along the order of the triangles.
class AreaWalk {
 public:
  AreaWalk(const IndexedMesh& mesh, double total, std::size_t count)
      : mesh_(mesh), total_(total), count_(count), area_(triangle_area(mesh, mesh.triangles[0])) {}

  /// Adds the points that lie on triangles before `end`.
  void add_points_until(std::size_t end, SurfaceSamples& samples) {
    while (next_ < count_) {
      const double target = (static_cast<double>(next_) + 0.5) / static_cast<double>(count_) * total_;
      while (before_ + area_ < target && triangle_ + 1 < mesh_.triangles.size()) {
        if (triangle_ + 1 == end) return;
        before_ += area_;
        area_ = triangle_area(mesh_, mesh_.triangles[++triangle_]);
      }
      const double share = area_ > 0 ? std::clamp((target - before_) / area_, 0.0, 1.0) : 0;
      const Triangle& triangle = mesh_.triangles[triangle_];
      samples.points.push_back(point_in_triangle(mesh_, triangle, share, golden_ratio_sequence(next_++)));
    }
  }

 private:
  const IndexedMesh& mesh_;
  const double total_;
  const std::size_t count_;
  std::size_t triangle_ = 0, next_ = 0;  ///< where it is, and the point that comes next
  double before_ = 0, area_;             ///< of the triangles before this one, and of this one
};

/// False: cancelled.
bool add_points_by_area(const IndexedMesh& mesh, std::size_t count, const Progress& progress, SurfaceSamples& samples) {
  const auto total = total_area(mesh, progress);
  if (!total) return false;
  AreaWalk walk(mesh, *total, count);
  Stretches stretches(mesh.triangles.size(), progress);
  while (stretches.next()) walk.add_points_until(stretches.end(), samples);
  return !stretches.are_cancelled();
}

}  // namespace

Result<SurfaceSamples> sample_surface(const IndexedMesh& mesh, std::size_t count, const Progress& progress) {
  SurfaceSamples samples;
  samples.points.reserve(count);
  add_vertices(mesh, std::min(count / 2, mesh.positions.size()), samples);
  if (!add_points_by_area(mesh, count - samples.vertices, progress, samples)) {
    return Error{ErrorCode::cancelled, "sampling a surface was cancelled"};
  }
  return samples;
}

SurfaceSamples sample_surface(const IndexedMesh& mesh, std::size_t count) {
  return *sample_surface(mesh, count, NoProgress());
}

}  // namespace geosis
