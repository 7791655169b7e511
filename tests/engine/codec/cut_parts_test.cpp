#include "engine/codec/cut_parts.h"

#include <gtest/gtest.h>

#include "engine/codec/level_codec.h"
#include "tests/support/lattice_meshes.h"

namespace geosis {
namespace {

///   1---3---5      cut into one triangle each, the inner four vertices are seams
///   | \ | \ |
///   0---2---4
const IndexedMesh kStrip = {{{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {1, 1, 0}, {2, 0, 0}, {2, 1, 0}},
                            {{0, 2, 1}, {2, 3, 1}, {2, 4, 3}, {4, 5, 3}}};

TEST(PlanParts, OnePartHasNoSeams) {
  const PartPlan plan = plan_parts(kStrip, 4);
  EXPECT_EQ(plan.parts(), 1u);
  EXPECT_TRUE(plan.seams.empty());
  EXPECT_TRUE(cut_part(kStrip, {}, plan, 0).seams.empty());
}

TEST(PlanParts, NumbersVerticesThatSeveralPartsUse) {
  const PartPlan plan = plan_parts(kStrip, 1);
  EXPECT_EQ(plan.parts(), 4u);
  EXPECT_EQ(plan.seams, (std::vector<std::uint32_t>{0, 1, 2, 3, 4, 0}));
}

TEST(PlanParts, SizesDifferByOneAtMost) {
  const PartPlan plan = plan_parts(kStrip, 3);
  EXPECT_EQ(plan.first_triangle, (std::vector<std::size_t>{0, 2, 4}));
  const PartPlan uneven = plan_parts(test::sheet(3, 0), 7);  // 18 triangles
  EXPECT_EQ(uneven.first_triangle, (std::vector<std::size_t>{0, 6, 12, 18}));
}

/// Below 50,000 triangles parts cost bytes and time, beyond 100,000 they no longer spread over workers.
TEST(PlanParts, PartsOfBigLevelsHoldFiftyToAHundredThousandTriangles) {
  const std::int32_t limit = EncodeOptions().max_part_triangles;
  IndexedMesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {}};
  for (const std::size_t triangles : {100'001u, 125'000u, 200'000u, 200'001u, 299'999u, 979'572u}) {
    mesh.triangles.resize(triangles, {0, 1, 2});
    const PartPlan plan = plan_parts(mesh, limit);
    for (std::size_t part = 0; part < plan.parts(); ++part) {
      const std::size_t size = plan.first_triangle[part + 1] - plan.first_triangle[part];
      EXPECT_TRUE(size >= 50'000 && size <= 100'000) << triangles << " triangles, part of " << size;
    }
  }
}

TEST(CutPart, RenumbersVerticesInTheirOrder) {
  const MeshPart part = cut_part(kStrip, {}, plan_parts(kStrip, 2), 1);
  EXPECT_EQ(part.mesh.positions, (std::vector<Vec3f>{{1, 0, 0}, {1, 1, 0}, {2, 0, 0}, {2, 1, 0}}));
  EXPECT_EQ(part.mesh.triangles, (std::vector<Triangle>{{0, 2, 1}, {2, 3, 1}}));
  EXPECT_EQ(part.seams, (std::vector<std::uint32_t>{1, 2, 0, 0}));
}

}  // namespace
}  // namespace geosis
