#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/pipeline/describe_bodies.h"
#include "engine/pipeline/reconstruct.h"
#include "engine/volume/brick_file.h"
#include "engine/volume/curvilinear_geometry.h"
#include "tests/support/mesh_checks.h"
#include "tests/support/scalar_field.h"

// Surfaces on grids whose nodes lie anywhere, the whole way.

namespace geosis {
namespace {

constexpr GridShape kShape = {34, 36, 38};
constexpr float kInfinity = std::numeric_limits<float>::infinity();

struct Field {
  const char* name;
  std::function<double(double, double, double)> value;  ///< the body is where it is not below zero
};
struct Bending {
  const char* name;
  bool is_mirrored;
  std::function<Vec3d(double, double, double)> place;
};

const Field kFields[] = {
    {"sphere", [](double x, double y, double z) { return 12 - std::hypot(x - 16.3, y - 17.7, z - 18.1); }},
    {"torus",
     [](double x, double y, double z) { return 4.2 - std::hypot(std::hypot(x - 16.3, y - 17.7) - 9.1, z - 18.2); }},
    {"gyroid",
     [](double x, double y, double z) {
       const double s = 0.41;
       return std::sin(s * x) * std::cos(s * y) + std::sin(s * y) * std::cos(s * z) + std::sin(s * z) * std::cos(s * x);
     }},
};

const Bending kBendings[] = {
    {"bent", false,
     [](double i, double j, double k) {
       const double angle = 0.03 * i, radius = 900 + 25 * j;
       return Vec3d{5e5 + radius * std::sin(angle), 6e6 + radius * std::cos(angle),
                    1000 + 4 * k + 20 * std::sin(0.1 * j)};
     }},
    {"mirrored", true,
     [](double i, double j, double k) {
       return Vec3d{5e5 + 12.5 * j, 6e6 + 25 * i, 1000 + 4 * k};
     }},
    {"sheared", false,
     [](double i, double j, double k) {
       return Vec3d{5e5 + 25 * i + 11 * j + 3 * k, 6e6 + 12.5 * j - 2 * k, 1000 + 4 * k + 3 * i - 2 * j};
     }},
};

std::unique_ptr<BrickedVolume> volume_of(const Field& field) {
  std::vector<float> samples;
  test::for_each_node(kShape, [&](GridIndex n) { samples.push_back(static_cast<float>(field.value(n.i, n.j, n.k))); });
  return make_bricked_volume(kShape, samples);
}

CurvilinearGeometry geometry_of(const Bending& bending) {
  std::vector<Vec3d> nodes;
  test::for_each_node(kShape, [&](GridIndex n) { nodes.push_back(bending.place(n.i, n.j, n.k)); });
  auto geometry = CurvilinearGeometry::from_nodes(kShape, nodes);
  EXPECT_TRUE(geometry) << geometry.error().message;
  return *std::move(geometry);
}

Reconstruction run(const BrickedVolume& volume, const GridGeometry& geometry, int threads = 2) {
  NoProgress progress;
  const ReconstructOptions options{.range = {0, kInfinity},
                                   .levels = by_ratio({1, 0.25, 0.0625}),
                                   .attributes = {.body = true},
                                   .normals = true,
                                   .threads = threads};
  auto result = reconstruct({volume, geometry}, options, progress);
  EXPECT_TRUE(result) << result.error().message;
  return result ? *std::move(result) : Reconstruction{};
}

TEST(Curvilinear, SurfacesHaveTheTopologyOfThePlainGrid) {
  for (const Field& field : kFields) {
    const auto volume = volume_of(field);
    const Reconstruction plain = run(*volume, AffineGeometry());
    for (const Bending& bending : kBendings) {
      SCOPED_TRACE(std::string(field.name) + ", " + bending.name);
      const CurvilinearGeometry geometry = geometry_of(bending);
      EXPECT_EQ(geometry.mirrored(), bending.is_mirrored);
      const Reconstruction curved = run(*volume, geometry);
      ASSERT_EQ(curved.levels.size(), 3u);
      const test::MeshCensus m0 = test::census(curved.levels[0].lod.mesh);
      EXPECT_TRUE(m0.is_closed_manifold()) << m0;
      EXPECT_EQ(m0.off_lattice, 0);
      for (const ReconstructedLevel& level : curved.levels) {
        EXPECT_TRUE(level.topology.manifold);
        EXPECT_EQ(level.topology.components, plain.levels[0].topology.components);
        EXPECT_EQ(level.topology.euler, plain.levels[0].topology.euler);
        EXPECT_EQ(level.topology.boundary_loops, 0);
        EXPECT_GT(level.measures.volume, 0);
        EXPECT_NEAR(level.measures.volume, curved.levels[0].measures.volume, 0.05 * curved.levels[0].measures.volume);
      }
      EXPECT_LT(curved.levels[2].topology.triangles, curved.levels[0].topology.triangles / 8);
    }
  }
}

TEST(Curvilinear, SurfacesLieWhereTheNodesSay) {
  const auto volume = volume_of(kFields[0]);
  for (const Bending& bending : kBendings) {
    SCOPED_TRACE(bending.name);
    const CurvilinearGeometry geometry = geometry_of(bending);
    const Reconstruction plain = run(*volume, AffineGeometry());
    const Reconstruction curved = run(*volume, geometry);
    const auto& m = curved.transform;
    ASSERT_EQ(m[0], m[5]);
    EXPECT_EQ(m[0], 4);  // the largest power of two not above the median edge along the samples, 4 to 6 m
    const IndexedMesh& mesh = curved.levels[0].lod.mesh;
    ASSERT_EQ(mesh.positions.size(), plain.levels[0].lod.mesh.positions.size());
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
      const Vec3d truth = geometry.map(to_double(plain.levels[0].lod.mesh.positions[v]));
      const Vec3f p = mesh.positions[v];
      EXPECT_NEAR(m[0] * p.x + m[3], truth.x, m[0] / 128 + 1e-6);
      EXPECT_NEAR(m[5] * p.y + m[7], truth.y, m[0] / 128 + 1e-6);
      EXPECT_NEAR(m[10] * p.z + m[11], truth.z, m[0] / 128 + 1e-6);
    }
  }
}

TEST(Curvilinear, VolumesAndBodiesAreThoseOfTheWorld) {
  const auto volume = volume_of(kFields[0]);
  NoProgress progress;
  const ReconstructOptions options{.range = {0, kInfinity}};
  const auto plain = describe_bodies({*volume, AffineGeometry()}, options, progress);
  const auto sheared = describe_bodies({*volume, geometry_of(kBendings[2])}, options, progress);
  ASSERT_TRUE(plain && sheared);
  ASSERT_EQ(sheared->size(), 1u);
  // The determinant of the shear.
  const double cell = dot(Vec3d{25, 0, 3}, cross(Vec3d{11, 12.5, -2}, Vec3d{3, -2, 4}));
  EXPECT_NEAR((*sheared)[0].surface.volume, (*plain)[0].surface.volume * cell,
              1e-3 * (*plain)[0].surface.volume * cell);
  EXPECT_EQ((*sheared)[0].samples.voxels, (*plain)[0].samples.voxels);
}

TEST(Curvilinear, SurfacesAreTheSameForAnyNumberOfThreads) {
  const auto volume = volume_of(kFields[2]);
  const CurvilinearGeometry geometry = geometry_of(kBendings[0]);
  const Reconstruction one = run(*volume, geometry, 1), three = run(*volume, geometry, 3);
  for (std::size_t k = 0; k < one.levels.size(); ++k) {
    ASSERT_EQ(one.levels[k].encoded.parts.size(), three.levels[k].encoded.parts.size());
    EXPECT_EQ(one.levels[k].encoded.parts[0].bytes, three.levels[k].encoded.parts[0].bytes);
  }
}

}  // namespace
}  // namespace geosis
