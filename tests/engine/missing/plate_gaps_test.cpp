#include "engine/missing/plate/plate_gaps.h"

#include <gtest/gtest.h>

#include "tests/engine/missing/gap_boxes.h"

namespace geosis::test {
namespace {

template <class IsMissing>
PlateGaps gaps_of(const IsMissing& is_missing) {
  GapBox gap = known_box({16, 16, 16}, [](int, int, int) { return 0; });
  knock_out(gap, is_missing);
  return find_plate_gaps(gap, NoProgress());
}

TEST(PlateGaps, JoinsNodesThatShareAStencil) {
  const auto two_with_offset = [](int i, int j, int k) {
    return gaps_of([=](int a, int b, int c) {
             return (a == 5 && b == 5 && c == 5) || (a == 5 + i && b == 5 + j && c == 5 + k);
           })
        .gaps.size();
  };
  EXPECT_EQ(two_with_offset(0, 0, 2), 1u);
  EXPECT_EQ(two_with_offset(2, 0, 0), 1u);
  EXPECT_EQ(two_with_offset(1, -1, 0), 1u);
  EXPECT_EQ(two_with_offset(0, 3, 0), 0u);
  EXPECT_EQ(two_with_offset(1, 1, 1), 0u);
  EXPECT_EQ(two_with_offset(2, 1, 0), 0u);
}

TEST(PlateGaps, ListsGapsByTheirFirstNodeAndNodesByPlace) {
  const PlateGaps gaps = gaps_of([](int i, int j, int) { return (i == 3 || i == 9) && (j == 4 || j == 5); });
  ASSERT_EQ(gaps.gaps.size(), 2u);
  EXPECT_TRUE(gaps.single.empty());
  for (const PlateGap& gap : gaps.gaps) {
    EXPECT_EQ(gap.last - gap.first, 32u);
    for (std::uint32_t n = gap.first + 1; n < gap.last; ++n) EXPECT_LT(gaps.nodes[n - 1].place, gaps.nodes[n].place);
  }
  EXPECT_LT(gaps.nodes[gaps.gaps[0].first].place, gaps.nodes[gaps.gaps[1].first].place);
}

TEST(PlateGaps, KnowsWideGapsByACubeOfFiveNodes) {
  const auto slab = [](int nodes) {
    return gaps_of([=](int i, int j, int k) { return i > 3 && i <= 3 + nodes && j > 2 && j < 12 && k > 2 && k < 12; });
  };
  EXPECT_FALSE(slab(4).gaps.at(0).wide);
  EXPECT_TRUE(slab(5).gaps.at(0).wide);
}

TEST(PlateGaps, KnowsScatteredNodesFromTraces) {
  EXPECT_TRUE(gaps_of([](int i, int j, int k) { return (i + 2 * j + 5 * k) % 7 == 0; }).gaps.at(0).scattered);
  EXPECT_FALSE(gaps_of([](int i, int j, int) { return i == 5 && j % 2 == 0; }).gaps.at(0).scattered);
}

TEST(PlateGaps, TakesAbsentNodesAndWhatLiesOutsideForUnavailable) {
  GapBox gap = known_box({5, 5, 5}, [](int, int, int) { return 0; });
  knock_out(gap, [](int i, int j, int k) { return i == 2 && j == 2 && k == 2; });
  EXPECT_EQ(find_plate_gaps(gap, NoProgress()).single.at(0).available, kWholePlate);
  remove(gap, [](int i, int j, int k) { return i == 2 && j == 2 && k == 4; });
  EXPECT_EQ(find_plate_gaps(gap, NoProgress()).single.at(0).available, kWholePlate & ~(1u << 12));
  GapBox flat = known_box({5, 5, 1}, [](int, int, int) { return 0; });
  knock_out(flat, [](int i, int j, int) { return i == 2 && j == 2; });
  EXPECT_EQ(find_plate_gaps(flat, NoProgress()).single.at(0).available, 0b1'1110'0111'1001'1111u);
}

}  // namespace
}  // namespace geosis::test
