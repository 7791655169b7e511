#include "server/documents/request_sections.h"

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

TEST(RequestMissing, ReadsEveryWayOfFilling) {
  const auto fill =
      request_with(R"("missing": {"method": "rbf", "kernel": "inverse_distance", "max_distance": 2.5})").value().fill;
  EXPECT_EQ(fill, (FillOptions{FillMethod::rbf, RbfKernel::inverse_distance, FillSteering::automatic, 2.5}));
  EXPECT_EQ(request_with(R"("missing": {"method": "rbf", "steer": "off"})").value().fill.steer, FillSteering::off);
  EXPECT_EQ(request_with(R"("missing": {"method": "linear"})").value().fill.method, FillMethod::linear);
  EXPECT_EQ(request_with(R"("cap": true)").value().fill, FillOptions{});
}

TEST(RequestMissing, IsCanonicalWithoutWhatHasNoEffect) {
  EXPECT_EQ(canonical(R"("missing": {"method": "none", "max_distance": 3, "steer": "on"})"),
            canonical(R"("cap": true)"));
  EXPECT_EQ(canonical(R"("missing": {"method": "linear", "kernel": "inverse_distance", "steer": "on"})"),
            canonical(R"("missing": {"method": "linear"})"));
  EXPECT_EQ(canonical(R"("missing": {"method": "rbf", "kernel": "inverse_distance", "steer": "on"})"),
            canonical(R"("missing": {"method": "rbf", "kernel": "inverse_distance"})"));
  EXPECT_NE(canonical(R"("missing": {"method": "rbf", "steer": "on"})"), canonical(R"("missing": {"method": "rbf"})"));
}

TEST(RequestMissing, RefusesWhatIsNoWayOfFilling) {
  expect_refused(R"("missing": {"method": "cubic"})",
                 "request /missing/method: \"cubic\"; expected \"none\" or \"linear\" or \"rbf\"");
  expect_refused(R"("missing": {"max_distance": 0})",
                 "request /missing/max_distance: 0; expected a number above 0 or null");
  expect_refused(R"("missing": {"max_distance": "far"})",
                 "request /missing/max_distance: \"far\"; expected a number above 0 or null");
}

TEST(RequestBodies, ReadsFilters) {
  const auto bodies =
      request_with(R"("bodies": {"min_voxels": 2.5, "largest": 3, "seeds": [[4, 5, 6], [1, 2, 3], [4, 5, 6]]})")
          .value()
          .bodies;
  EXPECT_EQ(bodies.min_voxels, 2.5);
  EXPECT_EQ(bodies.largest, 3u);
  EXPECT_EQ(bodies.seeds, (std::vector<GridIndex>{{1, 2, 3}, {4, 5, 6}}));
  EXPECT_FALSE(bodies.keeps_all());
  EXPECT_TRUE(request_with(R"("bodies": {"min_voxels": 0, "largest": null, "seeds": []})").value().bodies.keeps_all());
}

TEST(RequestBodies, AreTheSameInAnyOrderOfSeeds) {
  EXPECT_EQ(canonical(R"("bodies": {"seeds": [[4, 5, 6], [1, 2, 3]]})"),
            canonical(R"("bodies": {"seeds": [[1, 2, 3], [4, 5, 6], [1, 2, 3]]})"));
}

TEST(RequestBodies, RefusesWhatIsNoFilter) {
  expect_refused(R"("bodies": {"min_voxels": -1})",
                 "request /bodies/min_voxels: -1; expected a number of at least 0 or null");
  expect_refused(R"("bodies": {"largest": 0})",
                 "request /bodies/largest: 0; expected a whole number in [1, 2147483647] or null");
  expect_refused(R"("bodies": {"seeds": [[1, 2]]})",
                 "request /bodies/seeds/0: [1,2]; expected [i, j, k], node numbers from 0");
  expect_refused(R"("bodies": {"seeds": [[1, 2, 3], [1, 2, -3]]})",
                 "request /bodies/seeds/1: [1,2,-3]; expected [i, j, k], node numbers from 0");
}

TEST(RequestAttributes, AreReadInAnyOrder) {
  const auto options = request_with(R"("attributes": ["value", "body"], "attribute_volume": "abc")").value();
  EXPECT_EQ(options.attributes, (AttributeChoice{.reliability = false, .body = true, .value = true}));
  EXPECT_EQ(options.attribute_volume, "abc");
  EXPECT_EQ(canonical(R"("attributes": ["body", "reliability", "body"])")["attributes"], Json({"reliability", "body"}));
  EXPECT_EQ(canonical(R"("attributes": [])")["attributes"], Json::array());
}

TEST(RequestAttributes, NeedTheVolumeThatAValueIsOf) {
  expect_refused(R"("attributes": ["value"])",
                 "request /attribute_volume: null; expected the id of the volume that the attribute \"value\" is of");
  expect_refused(R"("attribute_volume": "abc")",
                 "request /attribute_volume: \"abc\"; expected null, as \"attributes\" does not ask for \"value\"");
  expect_refused(R"("attributes": ["colour"])",
                 "request /attributes/0: \"colour\"; expected \"reliability\", \"body\", \"value\" or \"agreement\"");
}

TEST(RequestVelocity, IsMetresASecond) {
  EXPECT_EQ(request_with(R"("velocity": 2500)").value().velocity, 2500);
  expect_refused(R"("velocity": 0)",
                 "request /velocity: 0; expected metres a second, above 0 and at most 20000, or null");
  expect_refused(R"("velocity": "fast")",
                 "request /velocity: \"fast\"; expected metres a second, above 0 and at most 20000, or null");
}

TEST(RequestVelocity, HasNoEffectInIndexSpace) {
  EXPECT_EQ(canonical(R"("space": "index", "velocity": 2500)"), canonical(R"("space": "index")"));
  EXPECT_NE(canonical(R"("velocity": 2500)"), canonical(R"("velocity": 2000)"));
}

}  // namespace
}  // namespace geosis::server
