#include "engine/isosurface/extract.h"

#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "engine/volume/brick_file.h"

namespace geosis {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

std::unique_ptr<BrickedVolume> sample_field(GridShape shape, const std::function<double(int, int, int)>& f) {
  std::vector<float> samples;
  for (int i = 0; i < shape.inlines; ++i) {
    for (int j = 0; j < shape.crosslines; ++j) {
      for (int k = 0; k < shape.samples; ++k) samples.push_back(static_cast<float>(f(i, j, k)));
    }
  }
  return make_bricked_volume(shape, samples);
}

Result<IndexedMesh> extract(const BrickedVolume& volume, IsoRange range, ExtractOptions options = {}) {
  if (options.region == GridBox{}) options.region = whole(volume.shape());
  NoProgress progress;
  return extract_body(volume, range, options, progress);
}

/// Exact: lattice positions make every term of the sum exact.
double volume_of(const IndexedMesh& mesh) {
  double sum = 0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3d p = to_double(mesh.positions[t[0]]), q = to_double(mesh.positions[t[1]]),
                r = to_double(mesh.positions[t[2]]);
    sum += dot(p, cross(q, r));
  }
  return sum / 6;
}

bool same(const IndexedMesh& a, const IndexedMesh& b) {
  return a.positions == b.positions && a.triangles == b.triangles;
}

TEST(ExtractBody, ConstantFieldInRangeGivesExactlyTheBox) {
  const auto volume = sample_field({4, 5, 70}, [](int, int, int) { return 1; });
  const auto mesh = extract(*volume, {0, 2});
  ASSERT_TRUE(mesh);
  EXPECT_DOUBLE_EQ(volume_of(*mesh), 3.0 * 4 * 69);
  EXPECT_EQ(mesh->triangles.size(), 2u * 2 * (3 * 4 + 3 * 69 + 4 * 69));
}

TEST(ExtractBody, BothEndsInfiniteIsTheDomain) {
  const auto volume = sample_field({3, 3, 3}, [](int i, int, int) { return i == 2 ? std::nan("") : 1; });
  const auto mesh = extract(*volume, {-kInfinity, kInfinity});
  ASSERT_TRUE(mesh);
  EXPECT_DOUBLE_EQ(volume_of(*mesh), 1.0 * 2 * 2);
}

TEST(ExtractBody, PlaneGivesTheExactHalf) {
  const auto volume = sample_field({70, 5, 5}, [](int i, int, int) { return i - 33.25; });
  for (const auto& [range, width] : {std::pair{IsoRange{0, kInfinity}, 69 - 33.25},
                                     {IsoRange{-kInfinity, 0}, 33.25},
                                     {IsoRange{-1.5f, 2.25f}, 3.75}}) {
    const auto mesh = extract(*volume, range);
    ASSERT_TRUE(mesh);
    EXPECT_DOUBLE_EQ(volume_of(*mesh), width * 4 * 4);
  }
}

TEST(ExtractBody, MirroredGeometryTurnsEveryTriangle) {
  const auto volume = sample_field({6, 6, 6}, [](int i, int j, int k) {
    return 7.1 - (i - 2.5) * (i - 2.5) - (j - 2.5) * (j - 2.5) - (k - 2.5) * (k - 2.5);
  });
  const auto plain = extract(*volume, {0, kInfinity});
  const auto mirrored = extract(*volume, {0, kInfinity}, {.mirrored = true});
  ASSERT_TRUE(plain && mirrored);
  EXPECT_GT(volume_of(*plain), 0);
  EXPECT_DOUBLE_EQ(volume_of(*mirrored), -volume_of(*plain));
}

TEST(ExtractBody, OneValueIsASlabOfTwoSheets) {
  const auto volume = sample_field({4, 4, 9}, [](int, int, int k) { return k; });
  const auto mesh = extract(*volume, {3.5f, 3.5f});
  ASSERT_TRUE(mesh);
  EXPECT_DOUBLE_EQ(volume_of(*mesh), 3.0 * 3 / 64);
}

TEST(ExtractBody, RegionIsCappedOnItsFaces) {
  const auto volume = sample_field({140, 4, 70}, [](int, int, int) { return 1; });
  const auto mesh = extract(*volume, {0, 2}, {.region = {{60, 1, 63}, {64, 3, 69}}});
  ASSERT_TRUE(mesh);
  EXPECT_DOUBLE_EQ(volume_of(*mesh), 4.0 * 2 * 6);
}

TEST(ExtractBody, WithoutCapNothingClosesTheBorder) {
  const auto volume = sample_field({5, 5, 5}, [](int i, int, int) { return i; });
  const auto mesh = extract(*volume, {1.5f, kInfinity}, {.cap = false});
  ASSERT_TRUE(mesh);
  EXPECT_EQ(mesh->positions.size(), 25u);
  EXPECT_EQ(mesh->triangles.size(), 32u);
}

TEST(ExtractBody, SampledModeLosesALayerBetweenSamples) {
  const auto volume = sample_field({4, 4, 4}, [](int, int, int k) { return k; });
  const auto exact = extract(*volume, {1.25f, 1.75f}),
             sampled = extract(*volume, {1.25f, 1.75f}, {.mode = BodyMode::sampled});
  ASSERT_TRUE(exact && sampled);
  EXPECT_DOUBLE_EQ(volume_of(*exact), 3.0 * 3 * 0.5);
  EXPECT_TRUE(sampled->triangles.empty());
}

TEST(ExtractBody, VerticesLieOnTheLatticeAwayFromNodes) {
  const auto volume = sample_field({9, 9, 9}, [](int i, int j, int k) {
    return std::fabs(i - 4) + std::fabs(j - 4) + std::fabs(k - 4) - 3;
  });  // zeros on nodes
  const auto mesh = extract(*volume, {-kInfinity, 0}, {.cap = false});
  ASSERT_TRUE(mesh);
  for (const Vec3f& p : mesh->positions) {
    int between = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const float steps = p[axis] * kLatticeStepsPerVoxel;
      EXPECT_EQ(steps, std::floor(steps));
      between += p[axis] != std::floor(p[axis]);
    }
    EXPECT_EQ(between, 1);
  }
}

TEST(ExtractBody, ThreadsDoNotChangeTheMesh) {
  const auto volume = sample_field({130, 70, 66}, [](int i, int j, int k) {
    return (i * 7 + j * 13 + k * 5) % 11 == 0 ? std::nan("") : (i * 31 + j * 17 + k * 29) % 23 - 11;
  });
  const auto one = extract(*volume, {-3, 4}, {.threads = 1}), two = extract(*volume, {-3, 4}, {.threads = 2}),
             eight = extract(*volume, {-3, 4}, {.threads = 8});
  ASSERT_TRUE(one && two && eight);
  EXPECT_GT(one->triangles.size(), 100000u);
  EXPECT_TRUE(same(*one, *two));
  EXPECT_TRUE(same(*one, *eight));
}

TEST(ExtractBody, NothingInRangeIsAnEmptyMesh) {
  const auto volume = sample_field({4, 4, 4}, [](int, int, int) { return 1; });
  const auto mesh = extract(*volume, {2, 3});
  ASSERT_TRUE(mesh);
  EXPECT_TRUE(mesh->positions.empty());
}

TEST(ExtractBody, RefusesRangesAndRegionsThatMakeNoSense) {
  const auto volume = sample_field({4, 4, 4}, [](int, int, int) { return 1; });
  for (const IsoRange range : {IsoRange{2, 1}, {std::nanf(""), 1}, {0, std::nanf("")}}) {
    const auto mesh = extract(*volume, range);
    ASSERT_FALSE(mesh);
    EXPECT_EQ(mesh.error().code, ErrorCode::invalid_argument);
  }
  for (const GridBox region : {GridBox{{0, 0, 0}, {4, 3, 3}}, {{-1, 0, 0}, {3, 3, 3}}, {{2, 0, 0}, {2, 3, 3}}}) {
    EXPECT_FALSE(extract(*volume, {0, 2}, {.region = region}));
  }
}

TEST(ExtractBody, SaysSoWhenTheSurfaceIsTooBig) {
  const auto volume = sample_field({4, 4, 4}, [](int, int, int) { return 1; });
  const auto mesh = extract(*volume, {0, 2}, {.max_triangles = 10});
  ASSERT_FALSE(mesh);
  EXPECT_EQ(mesh.error().code, ErrorCode::limit_exceeded);
}

TEST(ExtractBody, StopsWhenCancelled) {
  class Cancelled final : public Progress {
    void report(const char*, double) override {}
    bool cancelled() const override { return true; }
  } progress;
  const auto volume = sample_field({4, 4, 4}, [](int, int, int) { return 1; });
  const auto mesh = extract_body(*volume, {0, 2}, {.region = whole(volume->shape())}, progress);
  ASSERT_FALSE(mesh);
  EXPECT_EQ(mesh.error().code, ErrorCode::cancelled);
}

}  // namespace
}  // namespace geosis
