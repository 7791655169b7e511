#include "server/documents/request_levels.h"

#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "server/documents/request.h"

namespace geosis::server {
namespace {

Result<ReconstructOptions> request_with(const std::string& members) {
  return parse_request(parse_json(R"({"range": [0, 1], )" + members + "}").value());
}

Json canonical(const std::string& members) {
  return request_document(request_with(members).value(), {10, 20, 30});
}

void expect_refused(const std::string& members, const std::string& message) {
  const auto parsed = request_with(members);
  ASSERT_FALSE(parsed) << members;
  EXPECT_EQ(parsed.error().code, ErrorCode::invalid_argument) << members;
  EXPECT_EQ(parsed.error().message, message) << members;
}

TEST(RequestLevels, ReadsEveryMeasure) {
  const auto levels = request_with(R"("levels": [{"ratio": 1}, {"max_error": 0.5}, {"max_cost": 3, "error_cap": 2},
                                       {"ratio": 0.01, "error_cap": null, "drop": {"max_voxels": 8, "max_error": 0.5}}])")
                          .value()
                          .levels;
  ASSERT_EQ(levels.size(), 4u);
  EXPECT_EQ(levels[1].max_error, 0.5);
  EXPECT_FALSE(levels[1].ratio);
  EXPECT_EQ(levels[2].max_cost, 3);
  EXPECT_EQ(levels[2].error_cap, 2);
  EXPECT_EQ(levels[3].error_cap, std::numeric_limits<double>::infinity());
  EXPECT_EQ(levels[3].drop.max_voxels, 8);
  EXPECT_EQ(levels[3].drop.max_error, 0.5);
}

TEST(RequestLevels, WritesTheDefaultCapIntoTheCanonicalForm) {
  const Json levels =
      canonical(R"("levels": [{"ratio": 1}, {"ratio": 0.25}, {"ratio": 0.1, "error_cap": null}])")["levels"];
  EXPECT_TRUE(levels[0]["error_cap"].is_null());
  EXPECT_EQ(levels[1]["error_cap"], default_error_cap(0.25));
  EXPECT_TRUE(levels[2]["error_cap"].is_null());
  EXPECT_EQ(canonical(R"("levels": [{"ratio": 0.25}])"),
            canonical(R"("levels": [{"ratio": 0.25, "max_cost": null, "error_cap": )" +
                      Json(default_error_cap(0.25)).dump() + "}]"));
}

TEST(RequestLevels, AcceptTheirCanonicalForm) {
  const std::string members = R"("levels": [{"ratio": 1}, {"max_error": 0.5}, {"ratio": 0.1}])";
  const Json once = canonical(members);
  EXPECT_EQ(request_document(parse_request(once).value(), {10, 20, 30}), once);
}

TEST(RequestLevels, RefuseWhatIsNoLevel) {
  expect_refused(R"("levels": [{}])", "request /levels/0: {}; expected one of ratio, max_error and max_cost");
  expect_refused(R"("levels": [{"ratio": 0.5, "max_cost": 1}])",
                 "request /levels/0: {\"max_cost\":1,\"ratio\":0.5}; expected one of ratio, max_error and max_cost");
  expect_refused(R"("levels": [{"max_error": 1}, {"max_error": 1}])",
                 "request /levels/1/max_error: 1; expected more than the level before it has");
  expect_refused(R"("levels": [{"max_error": 0}])", "request /levels/0/max_error: 0; expected a number above 0");
  expect_refused(R"("levels": [{"ratio": 0.5, "error_cap": -1}])",
                 "request /levels/0/error_cap: -1; expected voxels from 0 on, or null = none");
  expect_refused(R"("levels": [{"ratio": 0.5, "drop": {"max_voxels": "few"}}])",
                 "request /levels/0/drop/max_voxels: \"few\"; expected a number from 0 on");
}

TEST(RequestSimplify, ReadsStrategyPlacementAndSeed) {
  const auto options =
      request_with(R"("simplify": {"strategy": "multiple_choice", "placement": "subset", "seed": 7})").value();
  EXPECT_EQ(options.strategy, Strategy::multiple_choice);
  EXPECT_EQ(options.placement, Placement::subset);
  EXPECT_EQ(options.seed, 7u);
}

TEST(RequestSimplify, HasNoSeedWhereNothingIsDrawn) {
  EXPECT_EQ(canonical(R"("simplify": {"seed": 7})"), canonical(R"("cap": true)"));
  EXPECT_NE(canonical(R"("simplify": {"strategy": "multiple_choice", "seed": 7})"),
            canonical(R"("simplify": {"strategy": "multiple_choice"})"));
}

}  // namespace
}  // namespace geosis::server
