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

TEST(EdgeContact, IsExactlyTheTwoDiagonalPatterns) {
  int contacts = 0;
  for (unsigned cells = 0; cells < 16; ++cells) contacts += is_edge_contact(cells);
  EXPECT_EQ(contacts, 2);
  EXPECT_TRUE(is_edge_contact(0b1001));
  EXPECT_TRUE(is_edge_contact(0b0110));
}

}  // namespace
}  // namespace geosis::contact
