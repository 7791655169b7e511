#include "engine/missing/gaps/bit_lines.h"

#include <vector>

#include <gtest/gtest.h>

#include "tests/support/random.h"

namespace geosis {
namespace {

TEST(BitLines, GivesRunsOfBitsAcrossWords) {
  BitLines lines(2, 130);
  lines.line(1)[0] = std::uint64_t{1} << 63;
  lines.line(1)[1] = 5;
  EXPECT_EQ(lines.bits(1, 63, 64), 1u | 2u | 8u);
  EXPECT_EQ(lines.bits(1, 63, 3), 3u);
  EXPECT_EQ(lines.bits(1, 126, 4), 0u);
  EXPECT_EQ(lines.count(), 3u);
}

/// Law: neighbours are what a walk along the line meets first.
TEST(BitLines, FindTheNextMarkOnEachSide) {
  test::Random random(7);
  for (const std::int32_t length : {1, 63, 64, 65, 200}) {
    BitLines lines(3, length);
    std::vector<bool> marks(static_cast<std::size_t>(length));
    for (std::size_t n = 0; n < marks.size(); ++n) {
      marks[n] = random.unit() < 0.05;
      if (marks[n]) lines.line(1)[n / 64] |= std::uint64_t{1} << n % 64;
    }
    for (std::int32_t n = 0; n < length; ++n) {
      std::int32_t before = n - 1, after = n + 1;
      while (before >= 0 && !marks[static_cast<std::size_t>(before)]) --before;
      while (after < length && !marks[static_cast<std::size_t>(after)]) ++after;
      EXPECT_EQ(lines.before(1, n), before);
      EXPECT_EQ(lines.after(1, n), after == length ? -1 : after);
      EXPECT_EQ(lines.test(1, n), marks[static_cast<std::size_t>(n)]);
      EXPECT_EQ(lines.before(0, n), -1);
      EXPECT_EQ(lines.after(2, n), -1);
    }
  }
}

}  // namespace
}  // namespace geosis
