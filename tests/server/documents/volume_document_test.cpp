#include "server/documents/volume_document.h"

#include <limits>

#include <gtest/gtest.h>

#include "server/documents/ids.h"

namespace geosis::server {
namespace {

VolumeDescription survey() {
  VolumeDescription volume;
  volume.shape = {76, 181, 268};
  volume.inline_axis = {.first = 1971, .step = 2, .byte = 5};
  volume.crossline_axis = {.first = 2775, .step = 1, .byte = 21};
  volume.sample_axis = {.first = 999, .step = 3};
  volume.sample_unit = "ms";
  volume.geometry = AffineGeometry({100, 200, 999}, {25, 0, 0}, {0, 12.5, 0}, {0, 0, 3});
  volume.value_range = {-0.5f, 1.5f};
  volume.missing_samples = 268;
  volume.missing_traces = 1;
  volume.format = "segy";
  volume.options.format = FileFormat::segy;
  return volume;
}

TEST(VolumeDocument, SaysWhereAndHowBigTheVolumeIs) {
  const Json document = volume_document(survey(), "build-up.sgy");
  EXPECT_EQ(document["id"], volume_id(survey()));
  EXPECT_EQ(document["name"], "build-up.sgy");
  EXPECT_EQ(document["dims"], Json({76, 181, 268}));
  EXPECT_EQ(document["axes"]["inline"], Json({{"first", 1971.0}, {"step", 2.0}, {"byte", 5}}));
  EXPECT_EQ(document["axes"]["sample"], Json({{"first", 999.0}, {"step", 3.0}, {"unit", "ms"}}));
  EXPECT_EQ(document["geometry"]["transform"],
            Json({25., 0., 0., 100., 0., 12.5, 0., 200., 0., 0., 3., 999., 0., 0., 0., 1.}));
  EXPECT_EQ(document["value_range"], Json({-0.5, 1.5}));
  EXPECT_EQ(document["missing"], Json({{"samples", 268}, {"traces", 1}}));
}

TEST(VolumeDocument, HasNullWhereNoSampleIsValid) {
  auto volume = survey();
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  volume.value_range = {kInfinity, -kInfinity};
  EXPECT_EQ(volume_document(volume, "")["value_range"], Json({nullptr, nullptr}));
}

TEST(VolumeDocument, IsValidTextWhateverTheTextHeaderHolds) {
  auto volume = survey();
  volume.text_header = "C 1 \xc3\x28\n\x01";
  EXPECT_TRUE(parse_json(document_text(volume_document(volume, "caf\xe9.sgy"))));
}

TEST(VolumeDocument, ListsWarnings) {
  auto volume = survey();
  volume.warnings.push_back({"samples_differ", "trace headers say 462, the file 75"});
  EXPECT_EQ(volume_document(volume, "")["warnings"],
            Json::array({{{"code", "samples_differ"}, {"detail", "trace headers say 462, the file 75"}}}));
}

TEST(VolumeDocument, KnowsWhichNodeTheSurveyMeans) {
  const Json document = volume_document(survey(), "");
  EXPECT_EQ(node_called(document, 0, 1971), 0);
  EXPECT_EQ(node_called(document, 0, 2121), 75);
  EXPECT_EQ(node_called(document, 0, 2123), std::nullopt);
  EXPECT_EQ(node_called(document, 0, 1972), std::nullopt);
  EXPECT_EQ(node_called(document, 1, 2774), std::nullopt);
  EXPECT_EQ(node_called(document, 2, 1002), 1);
}

TEST(CandidatesDocument, ListsEachGrid) {
  EXPECT_EQ(
      candidates_document({{189, 193, {5, 6, 50}, 3}}),
      Json::array({{{"inline_byte", 189}, {"crossline_byte", 193}, {"dims", {5, 6, 50}}, {"missing_traces", 3}}}));
  EXPECT_EQ(candidates_document({}), Json::array());
}

}  // namespace
}  // namespace geosis::server
