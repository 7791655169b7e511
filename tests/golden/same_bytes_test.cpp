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
                  "069d38a99b847a36309acfe86b0a327bc7ea7b629c9db002f45b2fa6e7d4e1cd");
}

TEST(SameBytes, OfABandWithoutCapInTheSampledMode) {
  const auto volume = synthetic_volume({70, 90, 66});
  expect_one_hash(*volume, {.range = {0.2f, 0.5f}, .mode = BodyMode::sampled, .cap = false},
                  "cd181575888463c4096cb4b38d97ea3e11ffe9920369f0934b07caf6c60ef485");
}

TEST(SameBytes, OfFilledSamplesAndWhatVerticesCarry) {
  const auto volume = synthetic_volume({70, 90, 66});
  const ReconstructOptions linear{.range = {0.6f, kInfinity},
                                  .fill = {.method = FillMethod::linear},
                                  .attributes = {.body = true},
                                  .normals = true};
  expect_one_hash(*volume, linear, "1be6ed57ba819a65a9613fdf5e34f5a8470cc610aa6b3b2f20a1f0987a5ed1c3");
  for (const auto& [fill, golden] : {
           std::pair{FillOptions{.method = FillMethod::rbf},
                     "fad1ffd35b9b2c938b548f4dc041013b50eded0bdffe867cd73d873ba7d2386a"},
           std::pair{FillOptions{.method = FillMethod::rbf, .kernel = RbfKernel::inverse_distance},
                     "04cfe44d856389cfded13ffc1b3d12468b5a9a8053410f6b133cbdbfaa67e1a8"},
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
                  "60cc1570e4adb82ea88f6571ae292bdaf83f2b87f97b7855c658b429ea912a5d");
}

}  // namespace
}  // namespace geosis
