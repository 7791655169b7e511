#pragma once

#include "engine/base/vec3.h"

namespace geosis {

/// A symmetric 3 x 3 matrix.
struct SymmetricMatrix {
  double xx = 0, yy = 0, zz = 0, xy = 0, xz = 0, yz = 0;
};

struct SymmetricEigen {
  Vec3d value;        ///< from the largest to the smallest
  Vec3d main_vector;  ///< of length 1, of the largest
};

/// Eigenvalues, and the vector of the largest, by Jacobi's rotations: only + - * / and sqrt. Of a finite matrix.
SymmetricEigen eigen_of(const SymmetricMatrix& matrix);

}  // namespace geosis
