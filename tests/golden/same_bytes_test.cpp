// Everything that leaves the engine, hashed: the same on every processor, under every vector target, for any number of
// threads, and the same as when these goldens were recorded.
//
// When a hash differs because output bytes were meant to change: raise kResultVersion in engine/pipeline/reconstruct.h
// and put the hashes that the failing test prints here.

#include <bit>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <hwy/highway.h>

#include "engine/base/digest.h"
#include "engine/pipeline/reconstruct.h"
#include "engine/volume/brick_file.h"
#include "engine/volume/formats/import.h"
#include "engine/volume/synthetic_survey.h"
#include "tests/support/shared_data.h"

namespace geosis {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr int kGoldenResultVersion = 3;

template <class T>
void add(Sha256& digest, const T& value) {
  static_assert(std::is_trivially_copyable_v<T>);
  digest.update(std::as_bytes(std::span(&value, 1)));
}

void add_certificate(Sha256& digest, const ReconstructedLevel& level) {
  const TopologyReport& t = level.topology;
  for (const std::int64_t count : {t.vertices, t.triangles, t.components, t.euler, t.genus, t.boundary_loops,
                                   std::int64_t{t.manifold}, level.distance.samples}) {
    add(digest, count);
  }
  for (const double measure : {level.measures.area, level.measures.volume, level.distance.mean_voxels,
                               level.distance.max_voxels, level.volume_drift, level.lod.cost}) {
    add(digest, measure);
  }
}

/// Hash of all parts and certificates of all levels.
std::string reconstruct_and_hash(const BrickedVolume& volume, const ReconstructOptions& options) {
  NoProgress progress;
  const auto result = reconstruct({volume, AffineGeometry()}, options, progress);
  EXPECT_TRUE(result) << result.error().message;
  Sha256 digest;
  for (const ReconstructedLevel& level : result->levels) {
    for (const EncodedPart& part : level.encoded.parts) digest.update(part.bytes);
    add_certificate(digest, level);
  }
  return std::move(digest).hex();
}

/// The synthetic survey, its missing traces as NaN.
std::unique_ptr<BrickedVolume> synthetic_volume(GridShape shape) {
  const SyntheticSurvey survey({.shape = shape});
  std::vector<float> samples(static_cast<std::size_t>(shape.count()), std::numeric_limits<float>::quiet_NaN());
  for (int i = 0; i < shape.inlines; ++i) {
    for (int j = 0; j < shape.crosslines; ++j) {
      if (!survey.has_trace(i, j)) continue;
      const auto at = static_cast<std::size_t>(i * shape.crosslines + j) * static_cast<std::size_t>(shape.samples);
      survey.fill_trace(i, j, std::span(samples).subspan(at, static_cast<std::size_t>(shape.samples)));
    }
  }
  return make_bricked_volume(shape, samples);
}

void expect_hash(const BrickedVolume& volume, ReconstructOptions options, int threads, const std::string& golden) {
  options.threads = threads;
  EXPECT_EQ(reconstruct_and_hash(volume, options), golden) << threads << " threads";
}

/// One hash for 1, 2 and 8 threads, and under every vector target that this processor has.
void expect_one_hash(const BrickedVolume& volume, const ReconstructOptions& options, const std::string& golden) {
  ASSERT_EQ(kResultVersion, kGoldenResultVersion) << "record the goldens of the new result version";
  for (const int threads : {1, 2, 8}) expect_hash(volume, options, threads, golden);
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    SCOPED_TRACE(hwy::TargetName(target));
    hwy::SetSupportedTargetsForTest(target);
    expect_hash(volume, options, 2, golden);
  }
  hwy::SetSupportedTargetsForTest(0);  // all targets again
}

TEST(SameBytes, OfTheSyntheticSurveyWithItsHoles) {
  const auto volume = synthetic_volume({70, 90, 66});
  expect_one_hash(*volume, {.range = {0.6f, kInfinity}},
                  "3c54d2cf78439fb97c9c775568600c3500c8198f4740a3a84c9ebd2ad1f539e5");
}

TEST(SameBytes, OfABandWithoutCapInTheSampledMode) {
  const auto volume = synthetic_volume({70, 90, 66});
  expect_one_hash(*volume, {.range = {0.2f, 0.5f}, .mode = BodyMode::sampled, .cap = false},
                  "13d00a10d7efb522800a11842ffa54dcbf2439293c7d2a956df9b45a7bb0b190");
}

TEST(SameBytes, OfFilledSamplesAndWhatVerticesCarry) {
  const auto volume = synthetic_volume({70, 90, 66});
  const ReconstructOptions linear{.range = {0.6f, kInfinity},
                                  .fill = {.method = FillMethod::linear},
                                  .attributes = {.body = true},
                                  .normals = true};
  expect_one_hash(*volume, linear, "a2af99507bab347d3a6862cf327862de2cd546182556dd1399159dcf9f80a44a");
  for (const auto& [fill, golden] : {
           std::pair{FillOptions{.method = FillMethod::rbf},
                     "75e66542d8694d4740971e6aa0494f726eaed2a6118e968e14dece01aff574dd"},
           std::pair{FillOptions{.method = FillMethod::rbf, .kernel = RbfKernel::inverse_distance},
                     "69a0b4e814a6d876627e84ab6385cc96669284bbbf9f24206b51f3a3bd4605dd"},
       }) {
    const ReconstructOptions rbf{.range = {0.6f, kInfinity}, .fill = fill};
    for (const int threads : {1, 8}) expect_hash(*volume, rbf, threads, golden);
  }
}

TEST(SameBytes, OfLevelsByRandomChoicesThatShareVertices) {
  const auto volume = synthetic_volume({70, 90, 66});
  expect_one_hash(
      *volume,
      {.range = {0.6f, kInfinity}, .strategy = Strategy::multiple_choice, .placement = Placement::subset, .seed = 7},
      "65a546bd230ae74f3d02c2728d9f3f38db0e16e63395ea06fbfa0a6d40398264");
}

TEST(SameBytes, OfARealSurvey) {
  const auto path = shared_file("seismic/petrel_buildup_3d.sgy");
  if (!exists(path)) GTEST_SKIP() << path << " is absent";
  NoProgress progress;
  const auto source = open_file(path);
  ASSERT_TRUE(source) << source.error().message;
  const auto imported = import_volume(**source, {}, std::nullopt, progress);
  ASSERT_TRUE(imported) << imported.error().message;
  expect_one_hash(*imported->samples, {.range = {0.5f, kInfinity}},
                  "6c14e1a1ba50879e6f2a55d1a9610ab9ab7b32d4e49f9194aac4cd0166584a2e");
}

}  // namespace
}  // namespace geosis
