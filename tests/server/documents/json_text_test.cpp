#include "server/documents/json_text.h"

#include <limits>
#include <string>

#include <gtest/gtest.h>

namespace geosis::server {
namespace {

std::string canonical(const char* text) {
  return canonical_text(parse_json(text).value());
}

TEST(ParseJson, RefusesWithLineAndColumn) {
  const auto parsed = parse_json("{\n  \"range\": [0.5,]}");
  ASSERT_FALSE(parsed);
  EXPECT_EQ(parsed.error().code, ErrorCode::malformed_input);
  EXPECT_NE(parsed.error().message.find("line 2, column 17"), std::string::npos) << parsed.error().message;
}

TEST(ParseJson, RefusesAMemberGivenTwice) {
  const auto parsed = parse_json(R"({"cap": true, "region": {"inline": 1}, "cap": false})");
  ASSERT_FALSE(parsed);
  EXPECT_EQ(parsed.error().message, "JSON: member \"cap\" given twice");
}

TEST(ParseJson, AcceptsTheSameMemberInTwoObjects) {
  EXPECT_TRUE(parse_json(R"([{"ratio": 1}, {"ratio": 0.5, "drop": {"ratio": 1}}])"));
}

TEST(ParseJson, RefusesWhatIsTooDeep) {
  const std::string deep = std::string(100'000, '[') + std::string(100'000, ']');
  ASSERT_FALSE(parse_json(deep));
  EXPECT_EQ(parse_json(deep).error().message, "JSON: deeper than 32 levels");
}

TEST(ParseJson, RefusesNumbersThatNoDoubleHolds) {
  EXPECT_FALSE(parse_json("[1e999]"));
  EXPECT_FALSE(parse_json("[NaN]"));
  EXPECT_FALSE(parse_json(""));
}

TEST(CanonicalText, SortsMembersAndDropsSpaces) {
  EXPECT_EQ(canonical(R"({ "b": [1, {"z": null, "a": true}], "a": "x" })"), R"({"a":"x","b":[1,{"a":true,"z":null}]})");
}

TEST(CanonicalText, WritesEqualNumbersAlike) {
  EXPECT_EQ(canonical("[1, 1.0, 1e0, 10e-1]"), "[1,1,1,1]");
  EXPECT_EQ(canonical("[0.5, 5e-1, 0.50]"), "[0.5,0.5,0.5]");
  EXPECT_EQ(canonical("[-0.0, 0.1, 1e300]"), "[0,0.1,1e+300]");
}

TEST(CanonicalText, KeepsEmptyObjectsAndArraysApart) {
  EXPECT_EQ(canonical("[{}, []]"), "[{},[]]");
}

TEST(DocumentText, ReplacesBytesThatAreNotUtf8) {
  EXPECT_EQ(document_text(Json("C 1\xff")), "\"C 1\xef\xbf\xbd\"\n");
}

TEST(NumberOrNull, TurnsNanAndInfinityIntoNull) {
  EXPECT_EQ(number_or_null(1.5), Json(1.5));
  EXPECT_TRUE(number_or_null(std::numeric_limits<double>::quiet_NaN()).is_null());
  EXPECT_TRUE(number_or_null(-std::numeric_limits<double>::infinity()).is_null());
}

}  // namespace
}  // namespace geosis::server
