#include "server/documents/node_grid_document.h"

#include <gtest/gtest.h>

#include "server/documents/grid_report.h"
#include "server/documents/request.h"
#include "server/documents/request_check.h"

namespace geosis::server {
namespace {

const std::string kId(64, 'c');
const NodeSummary kGrid = {.shape = {3, 4, 5},
                           .times = false,
                           .digest = kId,
                           .report = {.mirrored = true, .folded_cells = 1, .folded_share = 0.005},
                           .low = {1, 2, 3},
                           .high = {4, 5, 6},
                           .bytes = 888};

TEST(NodeGridDocument, SaysWhatTheGridIs) {
  EXPECT_EQ(node_grid_document(kGrid, "v", "pillars").dump(),
            R"({"id":")" + kId +
                R"(","volume":"v","kind":"pillars","dims":[3,4,5],"bytes":888,"mirrored":true,"folded_share":0.005,)"
                R"("times":false,"box":[[1.0,2.0,3.0],[4.0,5.0,6.0]]})");
}

TEST(PositionOptions, AreTheFewThatThereAre) {
  PositionFormat format;
  ASSERT_TRUE(set_position_option(format, "kind", "pillars"));
  ASSERT_TRUE(set_position_option(format, "dtype", "float64"));
  ASSERT_TRUE(set_position_option(format, "byte_order", "big"));
  EXPECT_EQ(format.kind, PositionFormat::Kind::pillars);
  EXPECT_TRUE(format.is_double && format.big_endian);
  EXPECT_EQ(set_position_option(format, "dtype", "int8").error().message,
            "dtype: \"int8\"; expected float32 or float64");
  EXPECT_FALSE(set_position_option(format, "kind", ""));
  EXPECT_FALSE(set_position_option(format, "byte_order", "auto"));
  EXPECT_FALSE(set_position_option(format, "dims", "3,4,5"));
}

TEST(ParseCoordinates, TakesIdsOfVolumesAndNothingElse) {
  const auto ids = parse_coordinates({{"z", kId}, {"x", nullptr}});
  ASSERT_TRUE(ids) << ids.error().message;
  EXPECT_EQ(ids->of[2], kId);
  EXPECT_FALSE(ids->of[0] || ids->of[1]);
  for (const char* text : {"{}", R"({"x": null})", "[]", R"({"x": "abc"})", R"({"y": 3})", R"({"w": null})"}) {
    const auto refused = parse_coordinates(*parse_json(text));
    ASSERT_FALSE(refused) << text;
    EXPECT_EQ(refused.error().code, ErrorCode::invalid_argument);
  }
}

TEST(PlacedOn, TakesTheTimesFromASurveyWhoseGridHasDepths) {
  const VolumeSummary survey{.id = "a", .shape = kGrid.shape, .geometry = {}, .sample_unit = "ms"};
  EXPECT_EQ(placed_on(survey, kGrid).sample_unit, "");
  NodeSummary times = kGrid;
  times.times = true;
  EXPECT_EQ(placed_on(survey, times).sample_unit, "ms");
}

TEST(RequestGrid, IsTheIdOfOneOrAWord) {
  const auto options = parse_request({{"range", {0, nullptr}}, {"grid", kId}});
  ASSERT_TRUE(options) << options.error().message;
  EXPECT_EQ(options->grid, GridChoice::curvilinear);
  EXPECT_EQ(options->grid_id, kId);
  EXPECT_EQ(request_document(*options, {3, 4, 5}).at("grid"), kId);
  for (const Json& grid : {Json("curvilinear"), Json(kId + "0"), Json(std::string(64, 'C')), Json(3), Json(nullptr)}) {
    const auto refused = parse_request({{"range", {0, nullptr}}, {"grid", grid}});
    ASSERT_FALSE(refused) << grid;
    EXPECT_NE(refused.error().message.find("/grid"), std::string::npos);
  }
}

TEST(CheckPlacedGrid, RefusesAVelocityOnlyWhereThereAreDepthsAlready) {
  ReconstructOptions options{.grid = GridChoice::curvilinear, .velocity = 2000};
  EXPECT_FALSE(check_placed_grid(options, {{"times", false}}));
  EXPECT_TRUE(check_placed_grid(options, {{"times", true}}));
  options.index_space = true;
  EXPECT_TRUE(check_placed_grid(options, {{"times", false}}));
  options = {.grid = GridChoice::curvilinear};
  EXPECT_TRUE(check_placed_grid(options, {{"times", false}}));
}

TEST(PlacedGridDocument, SaysHowFarToTrustIt) {
  const Json placed = placed_grid_document(kId, kGrid.report, 0.0625);
  EXPECT_EQ(placed.at("asked"), kId);
  EXPECT_EQ(placed.at("chosen"), "curvilinear");
  EXPECT_EQ(placed.at("folded_share"), 0.005);
  EXPECT_EQ(placed.at("lattice_step"), 0.0625);
  EXPECT_TRUE(placed_grid_document(kId, kGrid.report, std::nullopt).at("lattice_step").is_null());
}

}  // namespace
}  // namespace geosis::server
