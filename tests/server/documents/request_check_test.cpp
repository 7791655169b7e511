#include "server/documents/request_check.h"

#include <string>

#include <gtest/gtest.h>

namespace geosis::server {
namespace {

const VolumeSummary kTimeSurvey{.id = "a", .shape = {10, 20, 30}, .geometry = {}, .sample_unit = "ms"};
const VolumeSummary kDepthSurvey{.id = "b", .shape = {10, 20, 31}, .geometry = {}, .sample_unit = "m"};

std::string refusal(const Result<void>& result) {
  return result ? "" : result.error().message;
}

TEST(CheckRequest, TakesWhatLiesInTheVolume) {
  ReconstructOptions options{.range = {0, 1}};
  EXPECT_TRUE(check_request(options, kTimeSurvey));
  options.region = GridBox{{0, 0, 0}, {9, 19, 29}};
  options.bodies.seeds = {{9, 19, 29}};
  options.velocity = 2000;
  EXPECT_TRUE(check_request(options, kTimeSurvey));
}

TEST(CheckRequest, RefusesWhatLiesOutside) {
  ReconstructOptions options{.region = GridBox{{0, 0, 0}, {9, 20, 29}}};
  EXPECT_EQ(refusal(check_request(options, kTimeSurvey)),
            "request /region/crossline: [0,20]; the volume has nodes 0 to 19");
  options.region = std::nullopt;
  options.bodies.seeds = {{1, 1, 1}, {1, 1, 30}};
  EXPECT_EQ(refusal(check_request(options, kTimeSurvey)),
            "request /bodies/seeds: [1,1,30]; the volume has 10 x 20 x 30 nodes");
}

TEST(CheckRequest, RefusesAVelocityForDepths) {
  const ReconstructOptions options{.velocity = 2000};
  EXPECT_EQ(refusal(check_request(options, kDepthSurvey)),
            "request /velocity: given, but the samples of this volume are not times (their unit is \"m\")");
}

TEST(CheckAttributeVolume, MustHaveTheSameNodes) {
  EXPECT_TRUE(check_attribute_volume(kTimeSurvey, kTimeSurvey));
  EXPECT_EQ(refusal(check_attribute_volume(kDepthSurvey, kTimeSurvey)),
            "request /attribute_volume: a volume of 10 x 20 x 31 nodes; the volume itself has 10 x 20 x 30");
}

}  // namespace
}  // namespace geosis::server
