#include "tests/support/thin_layer.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/support/random.h"

namespace geosis::test {
namespace {

/// Depth below the layer's middle.
double below_middle(const ThinLayer& layer, double i, double j, double k) {
  const double middle = 0.5 * (layer.shape.samples - 1) + layer.dip * (i - 0.5 * (layer.shape.inlines - 1)) +
                        layer.dip * (j - 0.5 * (layer.shape.crosslines - 1));
  return k - middle;
}

/// Reaches kThinLayerLevel at half the thickness on both sides of 0.
double bright(double depth, double thickness) {
  const double x = 2 * depth / thickness;
  return std::exp2(-x * x);
}

/// Weaker reflectors around it, which leave the bright one alone.
double weak(double depth) {
  const double fade = 1 - std::exp(-depth * depth / 18);
  return 0.2 * fade * (std::sin(depth / 1.3 + 0.7) + 0.6 * std::sin(depth / 2.3) + 0.4 * std::cos(depth / 3.7)) / 1.5;
}

}  // namespace

ScalarField samples_of(const ThinLayer& layer) {
  ScalarField field(layer.shape);
  Random random(layer.seed);
  for_each_node(layer.shape, [&](GridIndex n) {
    const double depth = below_middle(layer, n.i, n.j, n.k);
    double noise = 0;
    for (int m = 0; layer.noise > 0 && m < 12; ++m) noise += random.unit() - 0.5;
    field.at(n) = static_cast<float>(bright(depth, layer.thickness) + weak(depth) + layer.noise * noise);
  });
  return field;
}

LayerFit fit_of(const ThinLayer& layer, const IndexedMesh& mesh) {
  const Vec3d truth = Vec3d{-layer.dip, -layer.dip, 1} * (1 / std::sqrt(2 * layer.dip * layer.dip + 1));
  double areas = 0, squared_angles = 0, errors = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3d p = to_double(mesh.positions[a]), q = to_double(mesh.positions[b]), r = to_double(mesh.positions[c]);
    const Vec3d centre = (p + q + r) * (1.0 / 3);
    bool is_cut = false;
    for (int axis = 0; axis < 3; ++axis) {
      is_cut |= centre[axis] < 2 || centre[axis] > layer.shape[axis] - 3;
    }
    const Vec3d normal = cross(q - p, r - p);
    const double area = norm(normal);
    if (is_cut || area == 0) continue;
    const double angle = std::acos(std::clamp(std::abs(dot(normal, truth)) / area, 0.0, 1.0)) * 180 / std::numbers::pi;
    const double depth = std::abs(below_middle(layer, centre.x, centre.y, centre.z));
    areas += area;
    squared_angles += area * angle * angle;
    errors += area * std::abs(depth - 0.5 * layer.thickness);
  }
  return {std::sqrt(squared_angles / areas), errors / areas};
}

}  // namespace geosis::test
