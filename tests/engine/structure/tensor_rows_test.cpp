#include "engine/structure/tensor_rows.h"

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/structure/symmetric_eigen.h"
#include "tests/support/random.h"

namespace geosis {
namespace {

TEST(MainDips, AreThoseOfTheMainEigenvector) {
  const std::uint64_t seed = test::test_seed(31);
  SCOPED_TRACE("seed " + std::to_string(seed));
  test::Random random(seed);
  constexpr std::size_t kCount = 500;
  std::vector<float> tensor(kTensorTerms * kCount, 0.0f), dip(2 * kCount);
  for (std::size_t k = 0; k < kCount; ++k) {
    // One strong gradient and two weak ones.
    for (const double size : {1.0, 0.4, 0.3}) {
      float g[3];
      for (float& c : g) c = static_cast<float>(size * random.between(-1, 1));
      if (size == 1.0) g[2] += g[2] < 0 ? -1.0f : 1.0f;
      std::vector<float> terms(kTensorTerms);
      const float weight = 1;
      gradient_products(g, &weight, 1, terms.data());
      for (std::size_t t = 0; t < kTensorTerms; ++t) tensor[t * kCount + k] += terms[t];
    }
  }
  main_dips(tensor.data(), kCount, 1e-9f, dip.data());
  for (std::size_t k = 0; k < kCount; ++k) {
    const auto at = [&](std::size_t t) { return double{tensor[t * kCount + k]}; };
    const SymmetricEigen eigen = eigen_of({at(0), at(1), at(2), at(3), at(4), at(5)});
    EXPECT_NEAR(dip[k], -eigen.main_vector.x / eigen.main_vector.z, 1e-4);
    EXPECT_NEAR(dip[kCount + k], -eigen.main_vector.y / eigen.main_vector.z, 1e-4);
  }
}

TEST(MainDips, AreUnknownWithoutContrast) {
  const std::vector<float> tensor(kTensorTerms * 3, 0.0f);
  std::vector<float> dip(6);
  main_dips(tensor.data(), 3, 1e-9f, dip.data());
  for (const float d : dip) EXPECT_TRUE(std::isnan(d));
}

}  // namespace
}  // namespace geosis
