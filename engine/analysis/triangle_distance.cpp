#include "engine/analysis/triangle_distance.h"

#include <algorithm>
#include <limits>

namespace geosis {
namespace {

double squared_distance_to_segment(Vec3d point, Vec3d a, Vec3d b) {
  const Vec3d along = b - a;
  const double length2 = dot(along, along);
  const double t = length2 > 0 ? std::clamp(dot(point - a, along) / length2, 0.0, 1.0) : 0;
  const Vec3d offset = point - (a + along * t);
  return dot(offset, offset);
}

}  // namespace

double squared_distance_to_triangle(Vec3d point, Vec3d a, Vec3d b, Vec3d c) {
  const Vec3d normal = cross(b - a, c - a);
  const bool inside_ab = dot(cross(b - a, point - a), normal) > 0;
  const bool inside_bc = dot(cross(c - b, point - b), normal) > 0;
  const bool inside_ca = dot(cross(a - c, point - c), normal) > 0;
  if (inside_ab && inside_bc && inside_ca) {
    const double height = dot(point - a, normal);
    return height * height / dot(normal, normal);
  }
  // The nearest point lies on an edge that the point is outside of; without a normal that is any edge.
  double nearest = std::numeric_limits<double>::infinity();
  if (!inside_ab) nearest = std::min(nearest, squared_distance_to_segment(point, a, b));
  if (!inside_bc) nearest = std::min(nearest, squared_distance_to_segment(point, b, c));
  if (!inside_ca) nearest = std::min(nearest, squared_distance_to_segment(point, c, a));
  return nearest;
}

}  // namespace geosis
