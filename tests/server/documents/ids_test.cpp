#include "server/documents/ids.h"

#include <set>
#include <string>

#include <gtest/gtest.h>

#include "server/documents/request.h"

namespace geosis::server {
namespace {

VolumeDescription described(const char* digest) {
  VolumeDescription volume;
  volume.digest = digest;
  volume.options.format = FileFormat::segy;
  volume.options.inline_byte = 189;
  return volume;
}

Json request(float low) {
  ReconstructOptions options;
  options.range = {low, 1};
  return request_document(options, {5, 5, 50});
}

TEST(VolumeId, DependsOnTheBytesAndOnEveryImportOption) {
  auto other_byte = described("aa");
  other_byte.options.inline_byte = 5;
  auto other_null = described("aa");
  other_null.options.null_value = 0;
  const std::set<std::string> ids = {volume_id(described("aa")), volume_id(described("ab")), volume_id(other_byte),
                                     volume_id(other_null)};
  EXPECT_EQ(ids.size(), 4u);
}

TEST(VolumeId, DoesNotDependOnWhatIsOnlyDescribed) {
  auto warned = described("aa");
  warned.warnings.push_back({"samples_differ", "..."});
  warned.text_header = "C 1";
  EXPECT_EQ(volume_id(warned), volume_id(described("aa")));
}

TEST(ExtractionId, DependsOnVolumeRequestAndResultVersion) {
  const std::set<std::string> ids = {extraction_id("aa", request(0.5f), 1), extraction_id("ab", request(0.5f), 1),
                                     extraction_id("aa", request(0.25f), 1), extraction_id("aa", request(0.5f), 2)};
  EXPECT_EQ(ids.size(), 4u);
}

TEST(ExtractionId, DoesNotDependOnTheOrderOfMembers) {
  Json reversed = Json::object();
  const Json document = request(0.5f);
  for (auto member = document.rbegin(); member != document.rend(); ++member) reversed[member.key()] = member.value();
  EXPECT_EQ(extraction_id("aa", reversed, 1), extraction_id("aa", document, 1));
}

// Stored results are found by these names: they change only together with the recipe's version line.
TEST(Ids, StayWhatTheyAre) {
  EXPECT_EQ(volume_id(described("aa")), "4d14ca8942e14e7f0f0501673b15ae7efe3ac09c9bda42890196373fd61b811b");
  EXPECT_EQ(extraction_id("aa", request(0.5f), 1), "bedcdf90978af5c7a1430878fab6763d26f50f44ca8406d671c6f9ddaab391b0");
}

}  // namespace
}  // namespace geosis::server
