#pragma once

#include <array>

namespace geosis {

/// Three rows of three.
using Matrix3 = std::array<double, 9>;

/// A linear map as glTF can hold it: the product outer * inner.
///
/// A glTF node's matrix must be a rotation times a scaling, which a survey whose inlines and crosslines are not at
/// right angles is not. Two nodes, one inside the other, hold any map: inner turns, the columns of outer are
/// orthogonal.
struct GltfMatrices {
  Matrix3 outer;
  Matrix3 inner;  ///< the identity where one node is enough
};

/// cost     a few rotations; uses + - * / sqrt alone, so that the numbers are the same on every processor.
/// source   Hestenes 1958, one-sided Jacobi: turns pairs of columns until all are orthogonal.
GltfMatrices split_for_gltf(const Matrix3& linear);

}  // namespace geosis
