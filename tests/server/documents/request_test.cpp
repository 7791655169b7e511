#include "server/documents/request.h"

#include <limits>
#include <string>

#include <gtest/gtest.h>

namespace geosis::server {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr GridShape kShape = {76, 181, 268};

Result<ReconstructOptions> request(const char* text) {
  return parse_request(parse_json(text).value());
}

std::string canonical(const char* text) {
  return canonical_text(request_document(request(text).value(), kShape));
}

void expect_refused(const char* text, ErrorCode code, const std::string& message) {
  const auto parsed = request(text);
  ASSERT_FALSE(parsed) << text;
  EXPECT_STREQ(name_of(parsed.error().code), name_of(code)) << text;
  EXPECT_EQ(parsed.error().message, message) << text;
}

TEST(ParseRequest, FillsInTheDefaults) {
  const auto options = request(R"({"range": [0.5, null]})").value();
  EXPECT_EQ(options.range.low, 0.5f);
  EXPECT_EQ(options.range.high, kInfinity);
  EXPECT_EQ(options.mode, BodyMode::exact);
  EXPECT_TRUE(options.cap);
  EXPECT_FALSE(options.region);
  EXPECT_FALSE(options.index_space);
  ASSERT_EQ(options.levels.size(), 5u);
  EXPECT_EQ(options.levels[0].ratio, 1);
  EXPECT_EQ(options.levels[4].ratio, 0.00390625);
}

TEST(ParseRequest, ReadsEveryFieldThatItSupports) {
  const auto options = request(R"({"range": [null, -1], "mode": "sampled", "cap": false, "space": "index",
    "region": {"inline": [0, 75], "crossline": [10, 180], "sample": [5, 267]}, "levels": [{"ratio": 1}, {"ratio": 0.1}],
    "codec": {"position_bits": 15, "speed": 4, "normals": false}})")
                           .value();
  EXPECT_EQ(options.range.low, -kInfinity);
  EXPECT_EQ(options.range.high, -1.0f);
  EXPECT_EQ(options.mode, BodyMode::sampled);
  EXPECT_FALSE(options.cap);
  EXPECT_TRUE(options.index_space);
  EXPECT_EQ(options.region, (GridBox{{0, 10, 5}, {75, 180, 267}}));
  ASSERT_EQ(options.levels.size(), 2u);
  EXPECT_EQ(options.levels[1].ratio, 0.1);
  EXPECT_EQ(options.position_bits, 15);
  EXPECT_EQ(options.speed, 4);
}

TEST(ParseRequest, AcceptsTheCanonicalFormAndKeepsIt) {
  const std::string once = canonical(R"({"range": [0.1, 7], "cap": false, "codec": {"speed": 10}})");
  EXPECT_EQ(canonical(once.c_str()), once);
}

TEST(ParseRequest, RoundsTheRangeToFloat32) {
  const auto document = request_document(request(R"({"range": [0.1, 0.3]})").value(), kShape);
  EXPECT_EQ(document["range"][0].get<double>(), static_cast<double>(0.1f));
  EXPECT_EQ(document["range"][1].get<double>(), static_cast<double>(0.3f));
}

TEST(ParseRequest, TakesEndsBeyondFloat32AsOpen) {
  const auto options = request(R"({"range": [-1e300, 1e300]})").value();
  EXPECT_EQ(options.range.low, -kInfinity);
  EXPECT_EQ(options.range.high, kInfinity);
}

TEST(ParseRequest, RefusesARangeThatMakesNoSense) {
  const auto wrong = ErrorCode::invalid_argument;
  expect_refused("{}", wrong, "request /range: null; expected [low, high], a null end being open");
  expect_refused(R"({"range": [1]})", wrong, "request /range: [1]; expected [low, high], a null end being open");
  expect_refused(R"({"range": ["a", 1]})", wrong, "request /range/0: \"a\"; expected a float32 number, or null = open");
  expect_refused(R"({"range": [1e300, null]})", wrong,
                 "request /range/0: 1e+300; expected a float32 number, or null = open");
  expect_refused(R"({"range": [2, 1]})", wrong, "request /range: [2,1]; expected low <= high");
}

TEST(ParseRequest, RefusesUnknownFieldsWithTheirPointer) {
  const auto wrong = ErrorCode::invalid_argument;
  expect_refused(R"({"range": [0, 1], "colour": 1})", wrong, "request /colour: there is no such field");
  expect_refused(R"({"range": [0, 1], "a/b~c": 1})", wrong, "request /a~1b~0c: there is no such field");
  expect_refused(R"({"range": [0, 1], "levels": [{"ratio": 1}, {"ratio": 0.5, "rat": 1}]})", wrong,
                 "request /levels/1/rat: there is no such field");
  expect_refused(R"({"range": [0, 1], "missing": {"metod": "none"}})", wrong,
                 "request /missing/metod: there is no such field");
}

TEST(ParseRequest, RefusesWrongTypesWithTheirPointer) {
  const auto wrong = ErrorCode::invalid_argument;
  expect_refused("[]", wrong, "request : []; expected an object");
  expect_refused(R"({"range": [0, 1], "cap": 1})", wrong, "request /cap: 1; expected true or false");
  expect_refused(R"({"range": [0, 1], "mode": "both"})", wrong,
                 "request /mode: \"both\"; expected \"exact\" or \"sampled\"");
  expect_refused(R"({"range": [0, 1], "codec": {"speed": 2.5}})", wrong,
                 "request /codec/speed: 2.5; expected a whole number in [0, 10] or null");
  expect_refused(R"({"range": [0, 1], "codec": 3})", wrong, "request /codec: 3; expected an object");
}

TEST(ParseRequest, RefusesLevelsThatDoNotFall) {
  const auto wrong = ErrorCode::invalid_argument;
  expect_refused(R"({"range": [0, 1], "levels": []})", wrong,
                 "request /levels: []; expected an array of 1 to 16 levels");
  expect_refused(R"({"range": [0, 1], "levels": [{"ratio": 2}]})", wrong,
                 "request /levels/0/ratio: 2; expected a number in (0, 1]");
  expect_refused(R"({"range": [0, 1], "levels": [{"ratio": 0.5}, {"ratio": 0.5}]})", wrong,
                 "request /levels/1/ratio: 0.5; expected less than the level before it has");
}

TEST(ParseRequest, RefusesRegionsThatAreNoBox) {
  const char* reversed = R"({"range": [0, 1], "region": {"inline": [5, 5], "crossline": [0, 1], "sample": [0, 1]}})";
  expect_refused(reversed, ErrorCode::invalid_argument,
                 "request /region/inline: [5,5]; expected [first, last], two node numbers from 0, first < last");
  const char* partial = R"({"range": [0, 1], "region": {"inline": [0, 5], "crossline": [0, 1]}})";
  expect_refused(partial, ErrorCode::invalid_argument,
                 "request /region/sample: null; expected [first, last], two node numbers from 0, first < last");
}

TEST(ParseRequest, MakesOneRequestOfEqualPreviews) {
  const std::string preview = canonical(R"({"range": [0, 1], "preview": true})");
  EXPECT_NE(preview, canonical(R"({"range": [0, 1]})"));
  EXPECT_NE(preview.find(R"("preview":true)"), std::string::npos) << preview;
  EXPECT_NE(preview.find(R"("ratio":1}],)"), std::string::npos) << preview;
  EXPECT_EQ(preview, canonical(R"({"range": [0, 1], "preview": true, "grid": "auto", "levels": [{"ratio": 0.5}],
                                   "missing": {"method": "linear"}, "attributes": []})"));
}

TEST(ParseRequest, RefusesPreviewsOfPlacedGrids) {
  const std::string text = R"({"range": [0, 1], "preview": true, "grid": ")" + std::string(64, 'a') + "\"}";
  expect_refused(text.c_str(), ErrorCode::invalid_argument,
                 "request /preview: true; expected false on a placed grid, which previews know nothing of");
}

TEST(ParseRequest, ShortensLongValuesInMessages) {
  const std::string text = R"({"range": [0, 1], "mode": ")" + std::string(1000, 'x') + "\"}";
  EXPECT_LT(request(text.c_str()).error().message.size(), 150u);
}

TEST(RequestDocument, IsTheSameForEqualRequests) {
  EXPECT_EQ(canonical(R"({"range": [0, 1]})"), canonical(R"({"range": [-0.0, 1.0], "cap": true, "velocity": null})"));
  EXPECT_EQ(
      canonical(R"({"range": [0, 1]})"),
      canonical(R"({"region": {"sample": [0, 267], "inline": [0, 75], "crossline": [0, 180]}, "range": [0, 1]})"));
  EXPECT_NE(canonical(R"({"range": [0, 1]})"), canonical(R"({"range": [0, 1], "cap": false})"));
}

// Ids are made of this text: when it changes, every stored extraction gets another name.
TEST(RequestDocument, HasThisCanonicalText) {
  EXPECT_EQ(
      canonical(R"({"range": [0.5, null], "levels": [{"ratio": 1}]})"),
      R"({"attribute_volume":null,"attributes":["reliability"],"bodies":{"largest":null,"min_voxels":0,"seeds":[]},)"
      R"("cap":true,"codec":{"normals":false,"position_bits":null,"speed":null},"grid":"given",)"
      R"("levels":[{"drop":{"max_error":0,"max_voxels":0},"error_cap":null,"ratio":1}],)"
      R"("missing":{"kernel":"polyharmonic","max_distance":null,"method":"none","steer":"auto"},"mode":"exact",)"
      R"("preview":false,"range":[0.5,null],)"
      R"("region":{"crossline":[0,180],"inline":[0,75],"sample":[0,267]},)"
      R"("simplify":{"placement":"optimal","seed":0,"strategy":"greedy"},"space":"world","velocity":null})");
}

TEST(RangeFromText, ReadsNumbersAndOpenEnds) {
  EXPECT_EQ(range_from_text("-0.5", "1e3").value(), Json({-0.5, 1000.0}));
  EXPECT_EQ(range_from_text("-inf", "infinity").value(), Json({nullptr, nullptr}));
}

TEST(RangeFromText, RefusesWhatIsNoEnd) {
  for (const char* low : {"nan", "", "1x", "0x", "inf", "1e999", " 1"}) {
    EXPECT_FALSE(range_from_text(low, "1")) << low;
  }
  EXPECT_FALSE(range_from_text("0", "-inf"));
}

}  // namespace
}  // namespace geosis::server
