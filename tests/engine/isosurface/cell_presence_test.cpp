#include "engine/isosurface/cell_presence.h"

#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "engine/volume/brick_file.h"

namespace geosis {
namespace {

constexpr GridShape kShape{70, 66, 130};

std::size_t at(int i, int j, int k) {
  return (static_cast<std::size_t>(i) * kShape.crosslines + static_cast<std::size_t>(j)) * kShape.samples +
         static_cast<std::size_t>(k);
}

/// Whether a cell is in the domain, from the samples themselves.
bool expected(const std::vector<float>& samples, const GridBox& region, GridIndex cell) {
  for (int axis = 0; axis < 3; ++axis) {
    if (cell[axis] < region.first[axis] || cell[axis] >= region.last[axis]) return false;
  }
  for (int corner = 0; corner < 8; ++corner) {
    if (std::isnan(samples[at(cell.i + corner / 4, cell.j + corner / 2 % 2, cell.k + corner % 2)])) return false;
  }
  return true;
}

TEST(CellPresence, SeesMissingSamplesAndRegionAcrossBricks) {
  std::mt19937 random(5);
  std::vector<float> samples(static_cast<std::size_t>(kShape.count()), 1.0f);
  for (int n = 0; n < 900; ++n) samples[random() % samples.size()] = std::nanf("");
  for (int n = 0; n < 200; ++n)
    samples[at(static_cast<int>(62 + random() % 3), static_cast<int>(62 + random() % 3),
               static_cast<int>(random() % 130))] = std::nanf("");
  const auto volume = make_bricked_volume(kShape, samples);
  for (const GridBox& region : {whole(kShape), GridBox{{3, 60, 62}, {65, 65, 127}}}) {
    for (const GridIndex brick : {GridIndex{0, 0, 0}, {0, 0, 1}, {1, 1, 1}, {1, 0, 2}, {0, 1, 0}}) {
      CellPresence presence;
      ASSERT_TRUE(presence.load(*volume, brick, region));
      EXPECT_FALSE(presence.is_complete());
      for (int a = -1; a < 64; ++a) {
        for (int b = -1; b < 64; ++b) {
          for (int c = -1; c < 64; ++c) {
            const GridIndex cell{brick.i * 63 + a, brick.j * 63 + b, brick.k * 63 + c};
            ASSERT_EQ(presence.is_present(a, b, c), expected(samples, region, cell))
                << cell.i << " " << cell.j << " " << cell.k;
          }
        }
      }
    }
  }
}

TEST(CellPresence, RowsOfNodesAndEdgesAgreeWithTheCellsAroundThem) {
  std::mt19937 random(6);
  std::vector<float> samples(static_cast<std::size_t>(kShape.count()), 1.0f);
  for (int n = 0; n < 30000; ++n) samples[random() % samples.size()] = std::nanf("");
  const auto volume = make_bricked_volume(kShape, samples);
  CellPresence presence;
  ASSERT_TRUE(presence.load(*volume, {0, 0, 1}, whole(kShape)));
  for (int a = 0; a < 64; ++a) {
    for (int b = 0; b < 64; ++b) {
      const std::uint64_t nodes = presence.nodes_of_cells(a, b), surrounded = presence.surrounded_nodes(a, b);
      for (int c = 0; c < 64; ++c) {
        const unsigned around = presence.around_node(a, b, c);
        ASSERT_EQ((nodes >> c) & 1, around != 0u) << a << " " << b << " " << c;
        ASSERT_EQ((surrounded >> c) & 1, around == 255u) << a << " " << b << " " << c;
        for (int axis = 0; axis < 3; ++axis) {
          ASSERT_EQ((presence.edges_of_cells(axis, a, b) >> c) & 1, presence.around_edge(axis, a, b, c) != 0u)
              << axis << " " << a << " " << b << " " << c;
        }
      }
    }
  }
}

TEST(CellPresence, IsCompleteInsideAVolumeWithoutGaps) {
  const GridShape shape{190, 190, 190};
  const std::vector<float> samples(static_cast<std::size_t>(shape.count()), 0.0f);
  const auto volume = make_bricked_volume(shape, samples);
  CellPresence presence;
  ASSERT_TRUE(presence.load(*volume, {1, 1, 1}, whole(shape)));
  EXPECT_TRUE(presence.is_complete());
  EXPECT_EQ(presence.around_node(63, 63, 63), 255u);
  ASSERT_TRUE(presence.load(*volume, {0, 1, 1}, whole(shape)));
  EXPECT_FALSE(presence.is_complete());
  EXPECT_EQ(presence.around_node(0, 5, 5), 0b11110000u);
}

}  // namespace
}  // namespace geosis
