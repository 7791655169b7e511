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
                  "b1a9046de29bb87d8c5b19b0e15dbde6dc3d43af749e06506db70b37552ce82c");
}

TEST(SameBytes, OfABandWithoutCapInTheSampledMode) {
  const auto volume = synthetic_volume({70, 90, 66});
  expect_one_hash(*volume, {.range = {0.2f, 0.5f}, .mode = BodyMode::sampled, .cap = false},
                  "e03245302c179722a55ee0271787509f7daa6b14345c7c55ffa1210a5e82f6ec");
}

TEST(SameBytes, OfFilledSamplesAndWhatVerticesCarry) {
  const auto volume = synthetic_volume({70, 90, 66});
  const ReconstructOptions linear{.range = {0.6f, kInfinity},
                                  .fill = {.method = FillMethod::linear},
                                  .attributes = {.body = true},
                                  .normals = true};
  expect_one_hash(*volume, linear, "ce5376679053338039de5f2f246e8c9b49d6d64e5f8011d24b8df8ee0a913fc3");
  for (const auto& [fill, golden] : {
           std::pair{FillOptions{.method = FillMethod::rbf},
                     "d2b0ae48296abbf366eab91396b76f4884745507e4eabe05602bfcea9eae939c"},
           std::pair{FillOptions{.method = FillMethod::rbf, .kernel = RbfKernel::inverse_distance},
                     "c0179f9dcf6598e62de82d99e0c05846a72ca906bcef50214096d39cb1f6cc55"},
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
      "15fb8bb3bb5692b22a905b70c00962e4bd98fa599e5e8ea6ac5850ea9dbf9e2f");
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
                  "0f0fae235fbc6350eb775e36c9bbdc12484652139de8d67c05688675ac3d38d8");
}

}  // namespace
}  // namespace geosis
