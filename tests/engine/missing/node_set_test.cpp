#include "engine/missing/node_set.h"

#include <utility>

#include <gtest/gtest.h>

#include "tests/support/random.h"
#include "tests/support/scalar_field.h"

namespace geosis {
namespace {

TEST(Transpose, TurnsRowsIntoColumns) {
  test::Random random(1);
  std::array<std::uint64_t, 64> square, turned;
  for (std::uint64_t& word : square) word = random.bits();
  turned = square;
  transpose(turned);
  for (std::size_t a = 0; a < 64; ++a)
    for (std::size_t b = 0; b < 64; ++b) ASSERT_EQ(turned[b] >> a & 1, square[a] >> b & 1) << a << " " << b;
}

TEST(BitLines, GivesRunsOfBitsAcrossWords) {
  BitLines lines(2, 130);
  lines.line(1)[0] = std::uint64_t{1} << 63;
  lines.line(1)[1] = 5;
  EXPECT_EQ(lines.bits(1, 63, 64), 1u | 2u | 8u);
  EXPECT_EQ(lines.bits(1, 63, 3), 3u);
  EXPECT_EQ(lines.bits(1, 126, 4), 0u);
  EXPECT_EQ(lines.count(), 3u);
}

/// Law: neighbours are what a walk along the axis meets first.
TEST(NodeSet, FindsTheNextMemberOnEachSide) {
  for (const GridShape shape : {GridShape{5, 70, 130}, GridShape{130, 4, 65}, GridShape{1, 66, 3}}) {
    test::Random random(7);
    BitLines along_k(static_cast<std::size_t>(shape.inlines) * static_cast<std::size_t>(shape.crosslines),
                     shape.samples);
    test::ScalarField members(shape);
    test::for_each_node(shape, [&](GridIndex n) {
      if (random.unit() > 0.03) return;
      members.at(n) = 1;
      along_k.line(static_cast<std::size_t>(n.i * shape.crosslines + n.j))[static_cast<std::size_t>(n.k / 64)] |=
          std::uint64_t{1} << n.k % 64;
    });
    NoProgress unwatched;
    const NodeSet set(shape, std::move(along_k), 2, unwatched);
    test::for_each_node(shape, [&](GridIndex n) {
      ASSERT_EQ(set.contains(n), members.at(n) == 1);
      for (int axis = 0; axis < 3; ++axis) {
        GridIndex before = n, after = n;
        do --before[axis];
        while (before[axis] >= 0 && members.at(before) == 0);
        do ++after[axis];
        while (after[axis] < shape[axis] && members.at(after) == 0);
        ASSERT_EQ(set.neighbours(axis, n).before, before[axis]);
        ASSERT_EQ(set.neighbours(axis, n).after, after[axis] == shape[axis] ? -1 : after[axis]);
      }
    });
  }
}

}  // namespace
}  // namespace geosis
