#include "engine/volume/formats/segy_write.h"

#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "tests/engine/volume/scratch_folder.h"

namespace geosis {
namespace {

SegySurvey turned_survey() {
  SegySurvey survey;
  survey.shape = {7, 5, 66};
  survey.inline_axis = {1000, 2};
  survey.crossline_axis = {500, -3};
  survey.sample_axis = {-100, 2.5};
  survey.geometry = AffineGeometry({412345.67, 6123456.78, 0}, {20, 15, 0}, {-7.5, 10, 0}, {0, 0, 2.5});
  survey.text = "C 1 SYNTHETIC SURVEY\nC 2 SECOND LINE";
  return survey;
}

float value(std::int32_t i, std::int32_t j, std::size_t k) {
  return static_cast<float>(i) * 1.25f - static_cast<float>(j) * 0.1f + static_cast<float>(k);
}

void fill(std::int32_t i, std::int32_t j, std::span<float> samples) {
  for (std::size_t k = 0; k < samples.size(); ++k) samples[k] = value(i, j, k);
}

Result<ImportedVolume> import_file(const std::filesystem::path& path) {
  NoProgress unwatched;
  const auto source = open_file(path);
  if (!source) return source.error();
  return import_volume(**source, {}, std::nullopt, unwatched);
}

TEST(WriteSegy, ComesBackAsItWas) {
  const ScratchFolder folder;
  const SegySurvey survey = turned_survey();
  NoProgress unwatched;
  const auto is_live = [](std::int32_t i, std::int32_t j) { return i != 3 || j != 2; };
  ASSERT_TRUE(write_segy(folder / "survey.sgy", survey, fill, is_live, unwatched));
  const auto volume = import_file(folder / "survey.sgy");
  ASSERT_TRUE(volume) << volume.error().message;
  const VolumeDescription& d = volume->description;
  EXPECT_EQ(d.shape, survey.shape);
  EXPECT_EQ(d.inline_axis.first, 1000);
  EXPECT_EQ(d.crossline_axis.first, 500 - 3 * 4);  // falling numbers come back rising
  EXPECT_EQ(d.sample_axis.first, -100);
  EXPECT_EQ(d.sample_axis.step, 2.5);
  EXPECT_EQ(d.text_header, survey.text);
  EXPECT_EQ(d.missing_traces, 1);
  EXPECT_TRUE(d.warnings.empty());
  const auto brick = volume->samples->brick(0);
  ASSERT_TRUE(brick);
  EXPECT_EQ(brick->samples[(2 * 5 + (4 - 1)) * 64 + 7], value(2, 1, 7));
  EXPECT_TRUE(std::isnan(brick->samples[(3 * 5 + (4 - 2)) * 64 + 7]));
  const Vec3d expected = survey.geometry.map({2, 1, 0}), actual = d.geometry.map({2, 3, 0});
  EXPECT_NEAR(actual.x, expected.x, 0.02);
  EXPECT_NEAR(actual.y, expected.y, 0.02);
}

TEST(WriteSegy, RefusesWhatHeadersCannotHold) {
  const ScratchFolder folder;
  NoProgress unwatched;
  const auto code = [&](const SegySurvey& survey) {
    return write_segy(folder / "survey.sgy", survey, fill, {}, unwatched).error().code;
  };
  SegySurvey survey = turned_survey();
  survey.shape.samples = 65536;
  EXPECT_EQ(code(survey), ErrorCode::invalid_argument);
  survey = turned_survey();
  survey.sample_axis.step = 66;
  EXPECT_EQ(code(survey), ErrorCode::invalid_argument);
  survey = turned_survey();
  survey.inline_axis.step = 0.5;
  EXPECT_EQ(code(survey), ErrorCode::invalid_argument);
  survey = turned_survey();
  survey.crossline_axis.step = 1e9;
  EXPECT_EQ(code(survey), ErrorCode::invalid_argument);
  survey = turned_survey();
  survey.geometry = AffineGeometry({3e7, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1});
  EXPECT_EQ(code(survey), ErrorCode::invalid_argument);
  EXPECT_TRUE(folder.is_empty());
}

TEST(WriteSegy, SaysSoWhenTheFileCannotBeWritten) {
  NoProgress unwatched;
  const auto nowhere = write_segy("/nonexistent/survey.sgy", turned_survey(), fill, {}, unwatched);
  EXPECT_EQ(nowhere.error().code, ErrorCode::unavailable);
  const auto full = write_segy("/dev/full", turned_survey(), fill, {}, unwatched);
  EXPECT_EQ(full.error().code, ErrorCode::no_space) << full.error().message;
}

}  // namespace
}  // namespace geosis
