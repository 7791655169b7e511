#include "engine/simplify/partition.h"

#include <algorithm>
#include <numeric>

#include <gtest/gtest.h>

#include "tests/engine/simplify/field_mesh.h"

namespace geosis {
namespace {

const IndexedMesh& gyroid_m0() {
  static const IndexedMesh mesh = mesh_field({20, 20, 20}, gyroid(9, 0.1));
  return mesh;
}

WorkingMesh gyroid_mesh() {
  return WorkingMesh(gyroid_m0());
}

template <class T>
std::vector<T> list(const Buffer<T>& buffer) {
  return {buffer.begin(), buffer.end()};
}

TEST(Partition, OrderIsAPermutation) {
  const WorkingMesh mesh = gyroid_mesh();
  const Partition partition = make_partition(mesh, 128, 1, 1);
  std::vector<std::int32_t> sorted = list(partition.order);
  std::sort(sorted.begin(), sorted.end());
  std::vector<std::int32_t> all(mesh.vertices());
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
  std::vector<Triangle> expected = gyroid_m0().triangles;
  std::sort(found.begin(), found.end());
  std::sort(expected.begin(), expected.end());
  EXPECT_EQ(found, expected);
}

TEST(Partition, LocksExactlyTheVerticesOfCrossingTriangles) {
  Partition partition = make_partition(gyroid_mesh(), 64, 0, 1);
  std::vector<std::uint8_t> crossing(partition.order.size(), 0);
  for (std::int32_t w = 0; w < partition.windows; ++w) {
    for (const Triangle& triangle : partition.crossing_of(w)) {
      for (const std::int32_t v : triangle) crossing[v] = 1;
    }
  }
  EXPECT_GT(partition.first_crossing.back(), 0u);
  EXPECT_EQ(partition.locked, crossing);
}

TEST(Partition, MovesItsSeamsFromPassToPass) {
  const WorkingMesh mesh = gyroid_mesh();
  std::vector<int> times_locked(mesh.vertices(), 0);
  for (std::uint32_t pass = 0; pass < 4; ++pass) {
    const Partition partition = make_partition(mesh, 1024, pass, 1);
    for (std::size_t i = 0; i < partition.order.size(); ++i) times_locked[partition.order[i]] += partition.locked[i];
  }
  const auto locked_in_all = std::count(times_locked.begin(), times_locked.end(), 4);
  EXPECT_GT(std::accumulate(times_locked.begin(), times_locked.end(), 0), static_cast<int>(mesh.vertices() / 5));
  EXPECT_LT(locked_in_all, static_cast<int>(mesh.vertices() / 50));
}

TEST(Partition, DoesNotDependOnThreads) {
  const WorkingMesh mesh = gyroid_mesh();
  const Partition one = make_partition(mesh, 128, 2, 1);
  const Partition three = make_partition(mesh, 128, 2, 3);
  EXPECT_EQ(list(one.order), list(three.order));
  EXPECT_EQ(one.first_triangle, three.first_triangle);
  EXPECT_EQ(one.first_crossing, three.first_crossing);
  EXPECT_TRUE(
      std::equal(one.triangles.begin(), one.triangles.begin() + one.first_triangle.back(), three.triangles.begin()));
  EXPECT_TRUE(
      std::equal(one.crossing.begin(), one.crossing.begin() + one.first_crossing.back(), three.crossing.begin()));
}

TEST(Partition, OneWindowKeepsTheOrder) {
  const IndexedMesh m0 = mesh_field({12, 12, 12}, ball({5.5, 5.5, 5.5}, 4));
  const WorkingMesh mesh(m0);
  const Partition partition = make_partition(mesh, 65'536, 5, 1);
  EXPECT_EQ(partition.windows, 1);
  EXPECT_TRUE(std::is_sorted(partition.order.begin(), partition.order.end()));
  EXPECT_EQ(partition.first_crossing.back(), 0u);
}

}  // namespace
}  // namespace geosis
