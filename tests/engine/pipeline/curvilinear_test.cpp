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

/// Two balls, the smaller one where cells are twenty times as long.
const Field kTwoBalls = {"two balls", [](double x, double y, double z) {
                           return std::max(7 - std::hypot(x - 8.3, y - 17.7, z - 18.1),
                                           5 - std::hypot(x - 25.3, y - 17.7, z - 18.1));
                         }};
const Bending kStretched = {"stretched", false, [](double i, double j, double k) {
                              return Vec3d{10 * i + (i > 17 ? 190 * (i - 17) : 0), 10 * j, 10 * k};
                            }};

TEST(Curvilinear, TheLargestBodiesAreThoseOfTheWorldAndSmallOnesThoseOfFewCells) {
  const auto volume = volume_of(kTwoBalls);
  const CurvilinearGeometry geometry = geometry_of(kStretched);
  const ReconstructInput input{.samples = *volume, .geometry = AffineGeometry(), .nodes = &geometry};
  ReconstructOptions options{.range = {0, kInfinity}, .grid = GridChoice::curvilinear, .levels = by_ratio({1})};
  NoProgress progress;
  const auto both = describe_bodies(input, options, progress);
  ASSERT_TRUE(both) << both.error().message;
  ASSERT_EQ(both->size(), 2u);
  EXPECT_LT((*both)[0].samples.voxels, (*both)[1].samples.voxels);
  EXPECT_GT((*both)[0].surface.volume, 5 * (*both)[1].surface.volume);
  options.bodies.largest = 1;
  const auto one = describe_bodies(input, options, progress);
  ASSERT_TRUE(one);
  ASSERT_EQ(one->size(), 1u);
  EXPECT_EQ((*one)[0].samples.voxels, (*both)[0].samples.voxels);
  options.attributes.value = true;
  ReconstructInput valued{.samples = *volume, .geometry = AffineGeometry(), .nodes = &geometry};
  valued.attribute_volume = volume.get();
  const auto surface = reconstruct(valued, options, progress);
  ASSERT_TRUE(surface);
  EXPECT_NEAR(surface->levels[0].measures.volume, (*one)[0].surface.volume, 1e-6 * (*one)[0].surface.volume);
  for (const float value : surface->levels[0].attributes.value) EXPECT_NEAR(value, 0, 0.05);
  options = {.range = {0, kInfinity}, .grid = GridChoice::curvilinear, .bodies = {.min_voxels = 800}};
  const auto many_cells = describe_bodies(input, options, progress);
  ASSERT_TRUE(many_cells);
  ASSERT_EQ(many_cells->size(), 1u);
  EXPECT_EQ((*many_cells)[0].samples.voxels, (*both)[1].samples.voxels);
}

TEST(Curvilinear, IndexSpaceIsThePlainGrid) {
  const auto volume = volume_of(kFields[1]);
  const CurvilinearGeometry geometry = geometry_of(kBendings[1]);
  NoProgress progress;
  ReconstructOptions options{.range = {0, kInfinity}, .levels = by_ratio({1, 0.25}), .index_space = true};
  const auto plain = reconstruct({*volume, AffineGeometry()}, options, progress);
  options.grid = GridChoice::curvilinear;
  const ReconstructInput input{.samples = *volume, .geometry = AffineGeometry(), .nodes = &geometry};
  const auto placed = reconstruct(input, options, progress);
  ASSERT_TRUE(plain && placed);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(placed->levels[k].encoded.parts[0].bytes, plain->levels[k].encoded.parts[0].bytes);
  }
  ASSERT_TRUE(placed->grid && placed->grid->nodes);
  EXPECT_TRUE(placed->grid->nodes->mirrored);
}

TEST(Curvilinear, RegionsAreCutFromTheWholeGrid) {
  const auto volume = volume_of(kFields[2]);
  const CurvilinearGeometry geometry = geometry_of(kBendings[0]);
  const GridBox region{{3, 5, 7}, {20, 30, 31}};
  NoProgress progress;
  ReconstructOptions options{.range = {0, kInfinity}, .region = region, .levels = by_ratio({1})};
  const auto plain = reconstruct({*volume, AffineGeometry()}, options, progress);
  const auto curved = reconstruct({*volume, geometry}, options, progress);
  ASSERT_TRUE(plain && curved);
  EXPECT_EQ(curved->levels[0].topology.euler, plain->levels[0].topology.euler);
  EXPECT_EQ(curved->levels[0].topology.components, plain->levels[0].topology.components);
  EXPECT_EQ(curved->levels[0].topology.boundary_loops, 0);
  const auto& m = curved->transform;
  const Vec3d first = geometry.map(to_double(plain->levels[0].lod.mesh.positions[0]));
  const Vec3f p = curved->levels[0].lod.mesh.positions[0];
  EXPECT_NEAR(m[0] * p.x + m[3], first.x, m[0] / 64);
  EXPECT_NEAR(m[10] * p.z + m[11], first.z, m[0] / 64);
}

TEST(Curvilinear, NothingInTheRangeHasAPlainTransform) {
  const auto volume = volume_of(kFields[0]);
  const auto result = [&] {
    NoProgress progress;
    const CurvilinearGeometry geometry = geometry_of(kBendings[0]);
    return reconstruct({*volume, geometry}, {.range = {1e6f, kInfinity}}, progress);
  }();
  ASSERT_TRUE(result);
  EXPECT_TRUE(result->levels.empty());
  EXPECT_EQ(result->transform, *AffineGeometry().affine());
}

TEST(Curvilinear, IsRefusedWithoutNodesOfItsShape) {
  const auto volume = volume_of(kFields[0]);
  const ReconstructOptions options{.range = {0, kInfinity}, .grid = GridChoice::curvilinear};
  NoProgress progress;
  EXPECT_FALSE(reconstruct({*volume, AffineGeometry()}, options, progress));
  std::vector<Vec3d> nodes;
  for (int n = 0; n < 8; ++n) nodes.push_back({1.0 * (n >> 2), 1.0 * (n >> 1 & 1), 1.0 * (n & 1)});
  const auto other = CurvilinearGeometry::from_nodes({2, 2, 2}, nodes);
  ASSERT_TRUE(other);
  const ReconstructInput input{.samples = *volume, .geometry = AffineGeometry(), .nodes = &*other};
  EXPECT_FALSE(reconstruct(input, options, progress));
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
