#pragma once

#include <array>
#include <memory>

#include "engine/base/vec3.h"

namespace geosis {

/// Where the grid's nodes are in the world. Affine or not: callers use map() and ask affine() only for shortcuts.
class GridGeometry {
 public:
  virtual ~GridGeometry() = default;

  /// World position of the index position (i, j, k), which may lie between nodes.
  virtual Vec3d map(Vec3d index) const = 0;
  /// The 4 x 4 row-major matrix of map() when it is affine (p = M * (i, j, k, 1)), else nullptr.
  virtual const std::array<double, 16>* affine() const = 0;
  /// True when map() turns right-handed index space into left-handed world space.
  virtual bool mirrored() const = 0;
};

/// origin + i * step_i + j * step_j + k * step_k.
class AffineGeometry final : public GridGeometry {
 public:
  AffineGeometry() : AffineGeometry({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}) {}
  AffineGeometry(Vec3d origin, Vec3d step_i, Vec3d step_j, Vec3d step_k)
      : matrix_{step_i.x, step_j.x, step_k.x, origin.x, step_i.y, step_j.y, step_k.y, origin.y,
                step_i.z, step_j.z, step_k.z, origin.z, 0,        0,        0,        1} {}

  Vec3d map(Vec3d p) const override {
    const auto& m = matrix_;
    return {m[0] * p.x + m[1] * p.y + m[2] * p.z + m[3], m[4] * p.x + m[5] * p.y + m[6] * p.z + m[7],
            m[8] * p.x + m[9] * p.y + m[10] * p.z + m[11]};
  }
  const std::array<double, 16>* affine() const override { return &matrix_; }
  bool mirrored() const override {
    const auto& m = matrix_;
    return dot(Vec3d{m[0], m[4], m[8]}, cross(Vec3d{m[1], m[5], m[9]}, Vec3d{m[2], m[6], m[10]})) < 0;
  }

 private:
  std::array<double, 16> matrix_;
};

}  // namespace geosis
