#include "tests/support/phantoms.h"

#include <cmath>
#include <limits>
#include <numbers>

#include "engine/base/vec3.h"

namespace geosis::test {
namespace {

// Off the nodes and off each other's symmetry planes, so that no saddle lies exactly on a level.
Vec3d from_centre(GridShape shape, GridIndex n) {
  return {n.i - 0.5 * (shape.inlines - 1) + 0.0625, n.j - 0.5 * (shape.crosslines - 1) - 0.09375,
          n.k - 0.5 * (shape.samples - 1) + 0.03125};
}

template <class Function>
ScalarField sampled(GridShape shape, Function&& function) {
  ScalarField field(shape);
  for_each_node(shape, [&](GridIndex n) { field.at(n) = static_cast<float>(function(from_centre(shape, n))); });
  return field;
}

}  // namespace

ScalarField sphere(GridShape shape, double radius) {
  return sampled(shape, [=](Vec3d p) { return radius - norm(p); });
}

ScalarField torus(GridShape shape, double ring_radius, double tube_radius) {
  return sampled(shape, [=](Vec3d p) { return tube_radius - std::hypot(std::hypot(p.x, p.y) - ring_radius, p.z); });
}

ScalarField two_tunnels(GridShape shape, double radius, double tunnel_radius) {
  return sampled(shape, [=](Vec3d p) {
    const double tunnel = std::min(std::hypot(p.x - radius / 2, p.y), std::hypot(p.x + radius / 2, p.y));
    return std::min(radius - norm(p), tunnel - tunnel_radius);
  });
}

ScalarField shell(GridShape shape, double radius, double thickness) {
  return sampled(shape, [=](Vec3d p) { return thickness / 2 - std::abs(radius - thickness / 2 - norm(p)); });
}

ScalarField two_sheets(GridShape shape, double gap) {
  return sampled(shape, [=](Vec3d p) { return std::abs(p.z + 0.1 * p.x) - gap / 2; });
}

ScalarField gyroid(GridShape shape, double period) {
  const double w = 2 * std::numbers::pi / period;
  return sampled(shape, [=](Vec3d p) {
    return std::sin(w * p.x) * std::cos(w * p.y) + std::sin(w * p.y) * std::cos(w * p.z) +
           std::sin(w * p.z) * std::cos(w * p.x);
  });
}

ScalarField plane(GridShape shape, double a, double b, double c, double d) {
  ScalarField field(shape);
  for_each_node(shape, [&](GridIndex n) { field.at(n) = static_cast<float>(a * n.i + b * n.j + c * n.k + d); });
  return field;
}

ScalarField uniform_noise(GridShape shape, Random& random, float low, float high) {
  ScalarField field(shape);
  for (float& f : field.samples) f = random.between(low, high);
  return field;
}

ScalarField integer_noise(GridShape shape, Random& random, std::int32_t low, std::int32_t high) {
  ScalarField field(shape);
  for (float& f : field.samples) f = static_cast<float>(random.integer(low, high));
  return field;
}

ScalarField with_holes(ScalarField field, Random& random, double probability) {
  for (float& f : field.samples)
    if (random.unit() < probability) f = std::numeric_limits<float>::quiet_NaN();
  return field;
}

}  // namespace geosis::test
