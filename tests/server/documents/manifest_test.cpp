#include "server/documents/manifest.h"

#include <limits>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "engine/base/digest.h"
#include "server/documents/ids.h"
#include "server/documents/request.h"

namespace geosis::server {
namespace {

VolumeDescription survey_in(std::string sample_unit) {
  VolumeDescription volume;
  volume.shape = {10, 20, 30};
  volume.sample_unit = std::move(sample_unit);
  volume.geometry = AffineGeometry({100, 200, 300}, {25, 0, 0}, {0, 25, 0}, {0, 0, 5});
  return volume;
}

VolumeDescription depth_survey() {
  return survey_in("m");
}

ReconstructOptions by_index_space() {
  ReconstructOptions options;
  options.index_space = true;
  return options;
}

ReconstructedLevel level_of(std::vector<std::vector<std::byte>> parts) {
  ReconstructedLevel level;
  for (auto& bytes : parts) level.encoded.parts.push_back({std::move(bytes), 10});
  level.topology = {.vertices = 12, .triangles = 20, .components = 1, .euler = 2, .manifold = true};
  level.measures = {.area = 7.5, .volume = 1.25};
  level.distance = {.mean_voxels = 0.5, .max_voxels = 1.5, .samples = 100};
  level.space_distance = SpaceDistance{12.5, 37.5};
  return level;
}

ManifestUrls urls() {
  return {.level = [](std::size_t level, std::size_t parts) -> std::optional<std::string> {
            return parts == 1 ? std::optional(std::to_string(level) + ".drc") : std::nullopt;
          },
          .part = [](std::size_t level, std::size_t part,
                     std::size_t) { return std::to_string(level) + "/" + std::to_string(part) + ".drc"; }};
}

Json manifest_of(const VolumeDescription& volume, const ReconstructOptions& options,
                 std::vector<ReconstructedLevel> levels) {
  return manifest_document(volume, options, {.levels = std::move(levels)}, urls());
}

TEST(ManifestDocument, NamesVolumeRequestAndEngine) {
  ReconstructOptions options;
  options.range = {0.5f, 1};
  const Json manifest = manifest_of(depth_survey(), options, {level_of({{std::byte{1}}})});
  EXPECT_EQ(manifest["volume"], volume_id(depth_survey()));
  EXPECT_EQ(manifest["request"], request_document(options, {10, 20, 30}));
  EXPECT_EQ(manifest["id"],
            extraction_id(volume_id(depth_survey()), request_document(options, {10, 20, 30}), kResultVersion));
  EXPECT_EQ(manifest["engine"], Json({{"name", "geosis"}, {"result_version", kResultVersion}}));
  EXPECT_EQ(manifest["empty"], false);
}

TEST(ManifestDocument, ListsPartsWithTheirDigests) {
  const auto level = level_of({{std::byte{1}, std::byte{2}}, {std::byte{3}}});
  const Json entry = manifest_of(depth_survey(), {}, {level})["levels"][0];
  EXPECT_EQ(entry["bytes"], 3);
  EXPECT_TRUE(entry["url"].is_null());
  EXPECT_EQ(entry["parts"][0]["url"], "0/0.drc");
  EXPECT_EQ(entry["parts"][1]["url"], "0/1.drc");
  EXPECT_EQ(entry["parts"][1]["bytes"], 1);
  EXPECT_EQ(entry["parts"][1]["triangles"], 10);
  EXPECT_EQ(entry["parts"][1]["sha256"], sha256_hex(level.encoded.parts[1].bytes));
}

TEST(ManifestDocument, CarriesTheCertificate) {
  auto level = level_of({{std::byte{1}}});
  level.asked.ratio = 0.25;
  level.lod.stopped_by = StoppedBy::floor;
  const Json entry = manifest_of(depth_survey(), {}, {level})["levels"][0];
  EXPECT_EQ(entry["asked"], Json({{"ratio", 0.25}}));
  EXPECT_EQ(entry["stopped_by"], "floor");
  EXPECT_EQ(entry["url"], "0.drc");
  EXPECT_EQ(entry["triangles"], 20);
  EXPECT_EQ(entry["euler"], 2);
  EXPECT_EQ(entry["manifold"], true);
  EXPECT_EQ(entry["area"], 7.5);
  EXPECT_EQ(entry["volume"], 1.25);
  EXPECT_EQ(entry["distance"]["max_voxels"], 1.5);
}

TEST(ManifestDocument, HasNoMeasuresForATimeSurveyInTheWorld) {
  const auto time_survey = survey_in("ms");
  const Json in_world = manifest_of(time_survey, {}, {level_of({{std::byte{1}}})})["levels"][0];
  EXPECT_TRUE(in_world["area"].is_null());
  EXPECT_TRUE(in_world["volume"].is_null());
  const Json by_index = manifest_of(time_survey, by_index_space(), {level_of({{std::byte{1}}})})["levels"][0];
  EXPECT_EQ(by_index["area"], 7.5);
}

TEST(ManifestDocument, HasMeasuresForATimeSurveyWithAVelocity) {
  ReconstructOptions options;
  options.velocity = 2000;
  const auto manifest = manifest_of(survey_in("ms"), options, {level_of({{std::byte{1}}})});
  EXPECT_EQ(manifest["levels"][0]["area"], 7.5);
  EXPECT_EQ(manifest["transform"][10], 5);  // 5 ms are 5 m down and up at 2000 m/s
  EXPECT_EQ(manifest["origin"][2], 300);
}

TEST(ManifestDocument, TellsDistancesInBothSpaces) {
  const Json distance = manifest_of(depth_survey(), {}, {level_of({{std::byte{1}}})})["levels"][0]["distance"];
  EXPECT_EQ(distance["mean_voxels"], 0.5);
  EXPECT_EQ(distance["mean"], 12.5);
  EXPECT_EQ(distance["max"], 37.5);
}

TEST(BodiesDocument, DescribesEveryBody) {
  DescribedBody body;
  body.surface = {.components = 3, .cavities = 2, .genus = 1, .volume = 250, .area = 90, .volume_voxels = 10.5};
  body.surface.low = {1, 2, 3};
  body.surface.high = {4, 5, 6};
  body.surface.interpolated_share = 0.25;
  body.samples = {.voxels = 12, .amplitude = BodySamples::Amplitude{0.75, 0.5f, 1}};
  const Json bodies = bodies_document(summarize(depth_survey()), {}, {body, {}})["bodies"];
  ASSERT_EQ(bodies.size(), 2u);
  EXPECT_EQ(bodies[0]["body"], 0);
  EXPECT_EQ(bodies[0]["voxels"], 12);
  EXPECT_EQ(bodies[0]["volume"], 250);
  EXPECT_EQ(bodies[0]["bbox"], Json({{1., 2., 3.}, {4., 5., 6.}}));
  EXPECT_EQ(bodies[0]["cavities"], 2);
  EXPECT_EQ(bodies[0]["amplitude"], Json({{"mean", 0.75}, {"min", 0.5}, {"max", 1.}}));
  EXPECT_EQ(bodies[0]["interpolated_share"], 0.25);
  EXPECT_EQ(bodies[1]["body"], 1);
  EXPECT_TRUE(bodies[1]["amplitude"].is_null());
  const Json in_time = bodies_document(summarize(survey_in("ms")), {}, {body})["bodies"][0];
  EXPECT_TRUE(in_time["volume"].is_null());
  EXPECT_EQ(in_time["volume_voxels"], 10.5);
}

TEST(ManifestDocument, TransformsToTheRequestedSpace) {
  const Json in_world = manifest_of(depth_survey(), {}, {});
  EXPECT_EQ(in_world["transform"], Json(*depth_survey().geometry.affine()));
  EXPECT_EQ(in_world["origin"], Json({100., 200., 300.}));
  const Json by_index = manifest_of(depth_survey(), by_index_space(), {});
  EXPECT_EQ(by_index["transform"], Json(*AffineGeometry().affine()));
  EXPECT_EQ(by_index["origin"], Json({0., 0., 0.}));
}

TEST(ManifestDocument, SaysWhenNothingWasInTheRange) {
  const Json manifest = manifest_of(depth_survey(), {}, {});
  EXPECT_EQ(manifest["empty"], true);
  EXPECT_EQ(manifest["levels"], Json::array());
}

TEST(ManifestDocument, HasNeitherNanNorInfinity) {
  auto level = level_of({{std::byte{1}}});
  level.volume_drift = std::numeric_limits<double>::quiet_NaN();
  level.lod.cost = std::numeric_limits<double>::infinity();
  const Json manifest = manifest_of(depth_survey(), {}, {level});
  EXPECT_TRUE(manifest["levels"][0]["volume_drift"].is_null());
  EXPECT_TRUE(parse_json(document_text(manifest)));
}

}  // namespace
}  // namespace geosis::server
