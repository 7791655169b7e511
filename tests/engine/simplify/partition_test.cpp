#include "engine/simplify/partition.h"

#include <algorithm>
#include <numeric>

#include <gtest/gtest.h>

#include "tests/engine/simplify/field_mesh.h"

namespace geosis {
namespace {

WorkingMesh working(const IndexedMesh& mesh) {
  const auto table = build_corner_table(mesh);
  EXPECT_TRUE(table);
  return make_working_mesh(mesh, *table);
}

WorkingMesh gyroid_mesh() {
  return working(mesh_field({20, 20, 20}, gyroid(9, 0.1)));
}

TEST(Partition, OrderIsAPermutation) {
  const WorkingMesh mesh = gyroid_mesh();
  const Partition partition = make_partition(mesh, 100, 1, 1);
  std::vector<std::int32_t> sorted = partition.order;
  std::sort(sorted.begin(), sorted.end());
  std::vector<std::int32_t> all(mesh.vertices.size());
  std::iota(all.begin(), all.end(), 0);
  EXPECT_EQ(sorted, all);
}

TEST(Partition, HoldsEachTriangleOnce) {
  const WorkingMesh mesh = gyroid_mesh();
  Partition partition = make_partition(mesh, 64, 3, 1);
  std::vector<Triangle> found;
  for (std::int32_t w = 0; w < partition.windows; ++w) {
    const std::int32_t* of = &partition.order[partition.first_vertex(w)];
    for (const auto [a, b, c] : partition.triangles_of(w)) found.push_back({of[a], of[b], of[c]});
    for (const auto& [a, b, c] : partition.crossing_of(w)) {
      found.push_back({partition.order[a], partition.order[b], partition.order[c]});
    }
  }
  std::vector<Triangle> expected = mesh.triangles;
  std::sort(found.begin(), found.end());
  std::sort(expected.begin(), expected.end());
  EXPECT_EQ(found, expected);
}

TEST(Partition, LocksExactlyTheVerticesOfCrossingTriangles) {
  Partition partition = make_partition(gyroid_mesh(), 64, 0, 1);
  std::vector<std::uint8_t> crossing(partition.order.size(), 0);
  for (const Triangle& triangle : partition.crossing) {
    for (const std::int32_t v : triangle) crossing[v] = 1;
  }
  EXPECT_FALSE(partition.crossing.empty());
  EXPECT_EQ(partition.locked, crossing);
}

TEST(Partition, MovesItsSeamsFromPassToPass) {
  const WorkingMesh mesh = gyroid_mesh();
  std::vector<int> times_locked(mesh.vertices.size(), 0);
  for (std::uint32_t pass = 0; pass < 4; ++pass) {
    const Partition partition = make_partition(mesh, 1024, pass, 1);
    for (std::size_t i = 0; i < partition.order.size(); ++i) times_locked[partition.order[i]] += partition.locked[i];
  }
  const auto locked_in_all = std::count(times_locked.begin(), times_locked.end(), 4);
  EXPECT_GT(std::accumulate(times_locked.begin(), times_locked.end(), 0), static_cast<int>(mesh.vertices.size() / 5));
  EXPECT_LT(locked_in_all, static_cast<int>(mesh.vertices.size() / 50));
}

TEST(Partition, DoesNotDependOnThreads) {
  const WorkingMesh mesh = gyroid_mesh();
  const Partition one = make_partition(mesh, 128, 2, 1);
  const Partition three = make_partition(mesh, 128, 2, 3);
  EXPECT_EQ(one.order, three.order);
  EXPECT_EQ(one.triangles, three.triangles);
  EXPECT_EQ(one.crossing, three.crossing);
}

TEST(Partition, OneWindowKeepsTheOrder) {
  const WorkingMesh mesh = working(mesh_field({12, 12, 12}, ball({5.5, 5.5, 5.5}, 4)));
  const Partition partition = make_partition(mesh, 65'536, 5, 1);
  EXPECT_EQ(partition.windows, 1);
  EXPECT_TRUE(std::is_sorted(partition.order.begin(), partition.order.end()));
  EXPECT_TRUE(partition.crossing.empty());
}

}  // namespace
}  // namespace geosis
