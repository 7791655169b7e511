#include "engine/isosurface/exact_sign.h"

#include <limits>
#include <random>

#include <gtest/gtest.h>

namespace geosis {
namespace {

__extension__ using Wide = __int128;

TEST(Exact, AddsWhatADoubleWouldLose) {
  const Exact sum = Exact(1e30) + Exact(1) - Exact(1e30);
  EXPECT_EQ(sum.sign(), 1);
  EXPECT_EQ((sum - Exact(1)).sign(), 0);
}

TEST(Exact, MultipliesWithoutRounding) {
  const double x = 1 + 0x1p-52;
  const Exact square = Exact(x) * Exact(x);  // 1 + 2^-51 + 2^-104
  EXPECT_EQ((square - Exact(1) - Exact(0x1p-51) - Exact(0x1p-104)).sign(), 0);
}

TEST(Exact, AgreesWithIntegersOnProducts) {
  std::mt19937_64 random(7);
  std::uniform_int_distribution<std::int64_t> number(-(std::int64_t{1} << 50), std::int64_t{1} << 50);
  for (int n = 0; n < 2000; ++n) {
    const std::int64_t a = number(random), b = number(random), c = number(random);
    const std::int64_t d = n % 2 ? number(random) : b;
    const Wide difference = Wide{a} * b - Wide{c} * d;
    const Exact exact = Exact(static_cast<double>(a)) * Exact(static_cast<double>(b)) -
                        Exact(static_cast<double>(c)) * Exact(static_cast<double>(d));
    EXPECT_EQ(exact.sign(), difference > 0 ? 1 : difference < 0 ? -1 : 0) << a << " " << b << " " << c << " " << d;
  }
}

TEST(Exact, KeepsTheSmallestAndLargestFloatsApart) {
  const double smallest = std::numeric_limits<float>::denorm_min(), largest = std::numeric_limits<float>::max();
  const Exact power = Exact(largest) * Exact(largest) * Exact(largest) * Exact(largest);
  const Exact tiny = Exact(smallest) * Exact(smallest) * Exact(smallest) * Exact(smallest);
  EXPECT_EQ((power + tiny - power).sign(), 1);
}

// g of the sampled mode: down to 2^-298, up to 2^258, scaled to 1.
TEST(Exact, KeepsProductsOfFloatsApartThatDifferMost) {
  const Exact tiny(0x1p-556), one(1);
  const Exact power = tiny * tiny * tiny * tiny;
  EXPECT_EQ((one + power - one).sign(), 1);
  EXPECT_EQ((power - tiny * tiny * tiny * Exact(0x3p-557)).sign(), -1);
}

TEST(Bounded, DoesNotDecideWhereProductsUnderflow) {
  const Bounded tiny(0x1p-556), rounded = Bounded(0x1.8p-556, 0x1p-600);
  EXPECT_FALSE((tiny * tiny).decides());
  EXPECT_FALSE((tiny * tiny - tiny * rounded).decides());
  EXPECT_FALSE((Bounded(0, 0x1p-600) * tiny).decides());
  EXPECT_TRUE((Bounded(0) * tiny).decides());
}

TEST(Bounded, NeverDecidesAgainstTheExactSign) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> number(-1, 1);
  int undecided = 0;
  for (int n = 0; n < 20000; ++n) {
    const double a = number(random), b = number(random), c = number(random);
    const double d = a * b / c * (1 + (n % 5 - 2) * 0x1p-52);  // next to a tie
    const Bounded estimate = Bounded(a) * Bounded(b) - Bounded(c) * Bounded(d);
    const int exact = (Exact(a) * Exact(b) - Exact(c) * Exact(d)).sign();
    if (!estimate.decides()) {
      ++undecided;
      continue;
    }
    EXPECT_EQ(exact, estimate.value > 0 ? 1 : estimate.value < 0 ? -1 : 0);
  }
  EXPECT_GT(undecided, 0);
}

}  // namespace
}  // namespace geosis
