#include "server/documents/grid_report.h"

#include <gtest/gtest.h>

namespace geosis::server {
namespace {

const DipReport kSteep = {
    .period = 14, .dips = {DipQuantiles{0.5, 1.5, 2}, DipQuantiles{0.25, 2.5, 4}}, .warped = false};

TEST(DipsDocument, IsReadAsItIsWritten) {
  const auto read = parse_dips_document(dips_document(kSteep));
  ASSERT_TRUE(read);
  EXPECT_EQ(*read, kSteep);
}

TEST(DipsDocument, IsRefusedWithoutOneOfItsNumbers) {
  for (const char* text : {"[]", "{}", R"({"period": 1, "inline": {}, "crossline": {}, "warped": false})",
                           R"({"period": 1, "inline": 2, "crossline": {}, "warped": false})"}) {
    const auto read = parse_dips_document(*parse_json(text));
    ASSERT_FALSE(read) << text;
    EXPECT_EQ(read.error().code, ErrorCode::malformed_input);
  }
  Json document = dips_document(kSteep);
  document["warped"] = "no";
  EXPECT_FALSE(parse_dips_document(document));
}

TEST(DecideGrid, NamesNoPeriodThatATraceCannotHold) {
  const DipReport slow = {.period = 992232.36, .dips = kSteep.dips, .warped = false};
  EXPECT_EQ(
      decide_grid(slow, 50).because,
      "95 % of the dips are within 2.50 samples a trace, which is not more than an eighth of the dominant period, "
      "which is longer than a trace");
  EXPECT_EQ(decide_grid(kSteep, 50).because, decide_grid(kSteep).because);
}

TEST(GridDocument, SaysWhatWasChosenAndWhy) {
  GridReport report{.dips = kSteep, .structure = StructureReport{kSteep, 0.125, 0.5}, .layers = 300};
  const Json chosen = grid_document(GridChoice::automatic, report);
  EXPECT_EQ(chosen["asked"], "auto");
  EXPECT_EQ(chosen["chosen"], "structural");
  EXPECT_EQ(chosen["because"],
            "95 % of the dips are within 2.50 samples a trace, which is more than an eighth of the dominant period of "
            "14.00 samples");
  EXPECT_EQ(chosen["layers"], 300);
  EXPECT_EQ(chosen["unreliable_share"], 0.125);
  report = {.dips = {.period = 40, .dips = kSteep.dips}};
  const Json left = grid_document(GridChoice::automatic, report);
  EXPECT_EQ(left["chosen"], "given");
  EXPECT_FALSE(left.contains("layers"));
}

}  // namespace
}  // namespace geosis::server
