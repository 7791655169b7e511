#include "engine/isosurface/contacts.h"

#include <gtest/gtest.h>

namespace geosis::contact {
namespace {

TEST(NodeCopies, InteriorAndEmptyNodesHaveNone) {
  EXPECT_EQ(node_copies(0).count, 0);
  EXPECT_EQ(node_copies(255).count, 0);
}

TEST(NodeCopies, ASingleCornerHasOne) {
  for (int octant = 0; octant < 8; ++octant) {
    EXPECT_EQ(node_copies(1u << octant).count, 1);
    EXPECT_EQ(node_copies(255u ^ (1u << octant)).count, 1);
  }
}

TEST(NodeCopies, CellsThatMeetOnlyAtThePointAreSplit) {
  EXPECT_EQ(node_copies(1u << 0 | 1u << 7).count, 2);
}

TEST(NodeCopies, CellsThatMeetOnlyAlongAnEdgeAreSplit) {
  EXPECT_EQ(node_copies(1u << 0 | 1u << 3).count, 2);
}

TEST(NodeCopies, AbsentCellsThatMeetOnlyAtThePointMakeTwoCones) {
  EXPECT_EQ(node_copies(255u ^ (1u << 0 | 1u << 7)).count, 2);
}

TEST(NodeCopies, AbsentCellsThatMeetAlongAnEdgeShareOneFan) {
  EXPECT_EQ(node_copies(255u ^ (1u << 0 | 1u << 3)).count, 1);
}

TEST(NodeCopies, FourSeparateCornersGiveFour) {
  EXPECT_EQ(node_copies(0b10010110 ^ 0u).count, 4);
}

TEST(NodeCopies, NameEveryBorderFaceAndNoOther) {
  for (unsigned cells = 0; cells < 256; ++cells) {
    const NodeCopies& copies = node_copies(cells);
    for (int octant = 0; octant < 8; ++octant) {
      for (int axis = 0; axis < 3; ++axis) {
        const bool present = (cells >> octant) & 1, across = (cells >> (octant ^ (4 >> axis))) & 1;
        const int copy = copies.copy[octant][axis];
        EXPECT_EQ(copy >= 0, present && !across) << cells << " " << octant << " " << axis;
        EXPECT_LT(copy, copies.count);
      }
    }
  }
}

TEST(CellGroups, AreJoinedAcrossFacesOnly) {
  EXPECT_EQ(cell_groups(0).count, 0);
  EXPECT_EQ(cell_groups(255).count, 1);
  EXPECT_EQ(cell_groups(255u ^ (1u << 0 | 1u << 7)).count, 1);  // though the vertex has two copies
  EXPECT_EQ(cell_groups(1u << 0 | 1u << 3).count, 2);
  EXPECT_EQ(cell_groups(0b10010110).count, 4);
}

TEST(CellGroups, NumberPresentCellsByTheLowestOctant) {
  const CellGroups& groups = cell_groups(1u << 1 | 1u << 5 | 1u << 6);
  EXPECT_EQ(groups.count, 2);
  EXPECT_EQ(groups.group, (std::array<std::int8_t, 8>{-1, 0, -1, -1, -1, 0, 1, -1}));
}

TEST(CellGroups, EachCopyOfTheVertexIsInOneOfThem) {
  for (unsigned cells = 0; cells < 256; ++cells) {
    std::array<int, 8> of_copy;
    of_copy.fill(-1);
    for (int octant = 0; octant < 8; ++octant) {
      for (const int copy : node_copies(cells).copy[octant]) {
        if (copy < 0) continue;
        const int group = cell_groups(cells).group[octant];
        EXPECT_TRUE(of_copy[copy] < 0 || of_copy[copy] == group) << cells;
        of_copy[copy] = group;
      }
    }
  }
}

TEST(EdgePlace, IsACellThatUsesTheCopy) {
  for (unsigned cells = 1; cells < 16; ++cells) {
    for (int copy = 0; copy < (is_edge_contact(cells) ? 2 : 1); ++copy) {
      const int place = edge_place(cells, copy);
      EXPECT_TRUE((cells >> place) & 1) << cells;
      EXPECT_TRUE(!is_edge_contact(cells) || edge_copy(place) == copy) << cells;
    }
  }
}

TEST(EdgeContact, IsExactlyTheTwoDiagonalPatterns) {
  int contacts = 0;
  for (unsigned cells = 0; cells < 16; ++cells) contacts += is_edge_contact(cells);
  EXPECT_EQ(contacts, 2);
  EXPECT_TRUE(is_edge_contact(0b1001));
  EXPECT_TRUE(is_edge_contact(0b0110));
}

}  // namespace
}  // namespace geosis::contact
