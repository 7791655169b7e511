#include "engine/structure/symmetric_eigen.h"

#include <string>

#include <gtest/gtest.h>

#include "tests/support/random.h"

namespace geosis {
namespace {

double determinant(const SymmetricMatrix& m) {
  return m.xx * (m.yy * m.zz - m.yz * m.yz) - m.xy * (m.xy * m.zz - m.yz * m.xz) + m.xz * (m.xy * m.yz - m.yy * m.xz);
}

Vec3d product(const SymmetricMatrix& m, Vec3d v) {
  return {m.xx * v.x + m.xy * v.y + m.xz * v.z, m.xy * v.x + m.yy * v.y + m.yz * v.z,
          m.xz * v.x + m.yz * v.y + m.zz * v.z};
}

void expect_is_eigen(const SymmetricMatrix& m, double size) {
  const SymmetricEigen eigen = eigen_of(m);
  EXPECT_GE(eigen.value.x, eigen.value.y);
  EXPECT_GE(eigen.value.y, eigen.value.z);
  EXPECT_NEAR(eigen.value.x + eigen.value.y + eigen.value.z, m.xx + m.yy + m.zz, 1e-13 * size);
  EXPECT_NEAR(eigen.value.x * eigen.value.y * eigen.value.z, determinant(m), 1e-12 * size * size * size);
  EXPECT_NEAR(norm(eigen.main_vector), 1, 1e-14);
  EXPECT_LE(norm(product(m, eigen.main_vector) - eigen.main_vector * eigen.value.x), 1e-13 * size);
}

TEST(SymmetricEigen, SolvesRandomMatrices) {
  const std::uint64_t seed = test::test_seed(7);
  SCOPED_TRACE("seed " + std::to_string(seed));
  test::Random random(seed);
  const auto number = [&] { return 2 * random.unit() - 1; };
  for (int n = 0; n < 2000; ++n) {
    expect_is_eigen({number(), number(), number(), number(), number(), number()}, 3);
  }
}

TEST(SymmetricEigen, SolvesProductsOfOneVector) {
  const Vec3d g = {1e-3, -0.5, 2};
  expect_is_eigen({g.x * g.x, g.y * g.y, g.z * g.z, g.x * g.y, g.x * g.z, g.y * g.z}, 5);
  EXPECT_NEAR(eigen_of({1, 1, 1, 1, 1, 1}).value.x, 3, 1e-14);
}

TEST(SymmetricEigen, OfZeroIsZero) {
  EXPECT_EQ(eigen_of({}).value, Vec3d{});
}

TEST(SymmetricEigen, ReadsADiagonal) {
  const SymmetricEigen eigen = eigen_of({1, 5, 3, 0, 0, 0});
  EXPECT_EQ(eigen.value, (Vec3d{5, 3, 1}));
  EXPECT_EQ(eigen.main_vector, (Vec3d{0, 1, 0}));
}

}  // namespace
}  // namespace geosis
