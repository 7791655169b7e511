#include "engine/volume/brick_layout.h"

#include <gtest/gtest.h>

namespace geosis {
namespace {

TEST(BrickLayout, CoversEveryCellOnceAndStoresBricksWithoutGaps) {
  for (const GridShape shape : {GridShape{2, 2, 2}, {1, 5, 64}, {64, 65, 127}, {130, 3, 190}, {63, 128, 1}}) {
    const BrickLayout layout(shape);
    std::uint64_t stored = 0;
    std::int64_t cells = 0;
    for (std::size_t brick = 0; brick < layout.brick_count(); ++brick) {
      const GridIndex place = layout.place(brick);
      const GridShape extent = layout.extent(place);
      EXPECT_EQ(layout.sample_offset(place), stored);
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_GE(extent[axis], shape[axis] == 1 ? 1 : 2);
        EXPECT_LE(layout.first_node(place)[axis] + extent[axis], shape[axis]);
      }
      stored += static_cast<std::uint64_t>(extent.count());
      cells += std::int64_t{extent.inlines - 1} * (extent.crosslines - 1) * (extent.samples - 1);
    }
    EXPECT_EQ(layout.stored_samples(), stored);
    EXPECT_EQ(cells, std::int64_t{shape.inlines - 1} * (shape.crosslines - 1) * (shape.samples - 1));
  }
}

TEST(BrickLayout, NeighboursShareOneLayer) {
  const BrickLayout layout({127, 127, 128});
  EXPECT_EQ(layout.grid(), (GridShape{2, 2, 3}));
  EXPECT_EQ(layout.extent({0, 0, 0}), (GridShape{64, 64, 64}));
  EXPECT_EQ(layout.first_node({1, 1, 2}), (GridIndex{63, 63, 126}));
  EXPECT_EQ(layout.extent({1, 1, 2}), (GridShape{64, 64, 2}));
}

TEST(CheckAxes, RefusesEmptyAndTooLongAxes) {
  EXPECT_TRUE(check_axes({1, kMaxAxisNodes, 2}));
  EXPECT_EQ(check_axes({0, 2, 2}).error().code, ErrorCode::invalid_argument);
  EXPECT_EQ(check_axes({2, -5, 2}).error().code, ErrorCode::invalid_argument);
  EXPECT_EQ(check_axes({2, 2, kMaxAxisNodes + 1}).error().code, ErrorCode::limit_exceeded);
}

}  // namespace
}  // namespace geosis
