#include "engine/codec/gltf_matrices.h"

#include <cmath>

#include "engine/base/vec3.h"

namespace geosis {
namespace {

constexpr Matrix3 kIdentity = {1, 0, 0, 0, 1, 0, 0, 0, 1};
constexpr int kMaxSweeps = 30;  // five are usual

Vec3d column(const Matrix3& m, int c) {
  return {m[c], m[3 + c], m[6 + c]};
}

void turn_columns(Matrix3& m, int p, int q, double cosine, double sine) {
  for (int row = 0; row < 9; row += 3) {
    const double at_p = m[row + p], at_q = m[row + q];
    m[row + p] = cosine * at_p - sine * at_q;
    m[row + q] = sine * at_p + cosine * at_q;
  }
}

/// Makes two columns orthogonal and turns the same columns of `turned`; false when they were orthogonal, to within what
/// coordinates in a file can say.
bool make_orthogonal(Matrix3& m, Matrix3& turned, int p, int q) {
  const Vec3d a = column(m, p), b = column(m, q);
  const double overlap = dot(a, b);
  if (std::abs(overlap) <= 1e-12 * norm(a) * norm(b)) return false;
  const double ratio = (dot(b, b) - dot(a, a)) / (2 * overlap);
  const double tangent = (ratio < 0 ? -1 : 1) / (std::abs(ratio) + std::sqrt(1 + ratio * ratio));
  const double cosine = 1 / std::sqrt(1 + tangent * tangent);
  turn_columns(m, p, q, cosine, cosine * tangent);
  turn_columns(turned, p, q, cosine, cosine * tangent);
  return true;
}

Matrix3 transposed(const Matrix3& m) {
  return {m[0], m[3], m[6], m[1], m[4], m[7], m[2], m[5], m[8]};
}

}  // namespace

GltfMatrices split_for_gltf(const Matrix3& linear) {
  Matrix3 outer = linear, turned = kIdentity;  // outer = linear * turned, throughout
  for (int sweep = 0; sweep < kMaxSweeps; ++sweep) {
    bool changed = make_orthogonal(outer, turned, 0, 1);
    changed |= make_orthogonal(outer, turned, 0, 2);
    changed |= make_orthogonal(outer, turned, 1, 2);
    if (!changed) break;
  }
  return {outer, transposed(turned)};
}

}  // namespace geosis
