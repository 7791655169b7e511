#include "server/grpc/messages/message_codec.h"

#include <cmath>
#include <limits>

#include <geosis/v1/extraction.pb.h>
#include <gtest/gtest.h>

#include "server/documents/request.h"

namespace geosis::server::rpc {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A request with a value in every field.
Json whole_request() {
  return *parse_json(R"({"range": [-0.5, null], "mode": "sampled",
    "missing": {"method": "rbf", "kernel": "inverse_distance", "steer": "auto", "max_distance": 3.5},
    "grid": "given", "space": "index", "velocity": null, "cap": false,
    "region": {"inline": [1, 5], "crossline": [0, 7], "sample": [2, 9]},
    "bodies": {"min_voxels": 2.5, "largest": 4, "seeds": [[1, 2, 3], [4, 5, 6]]},
    "levels": [{"ratio": 1, "error_cap": null, "drop": {"max_voxels": 0, "max_error": 0}},
               {"max_error": 2, "error_cap": 7, "drop": {"max_voxels": 3, "max_error": 1}},
               {"max_cost": 5, "error_cap": null, "drop": {"max_voxels": 3, "max_error": 1}}],
    "simplify": {"strategy": "multiple_choice", "placement": "optimal", "seed": 9},
    "codec": {"position_bits": 18, "normals": true, "speed": 3}, "attributes": ["reliability", "value"],
    "attribute_volume": "abc", "preview": false})");
}

TEST(MessageCodec, ARequestComesBackAsItWas) {
  v1::Request message;
  set_message(message, whole_request());
  EXPECT_FALSE(message.range().has_high());
  EXPECT_EQ(message.levels(0).error_cap(), kInfinity);
  EXPECT_EQ(message.bodies().seeds(1).k(), 6);
  const auto document = document_of(message);
  ASSERT_TRUE(document) << document.error().message;
  const auto meant = parse_request(*document), said = parse_request(whole_request());
  ASSERT_TRUE(meant && said) << meant.error().message;
  const GridShape shape{10, 10, 10};
  EXPECT_EQ(canonical_text(request_document(*meant, shape)), canonical_text(request_document(*said, shape)));
}

TEST(MessageCodec, WhatIsNotSetIsLeftOut) {
  v1::Request message;
  EXPECT_EQ(*document_of(message), Json::object());
  message.mutable_range()->set_low(1);
  EXPECT_EQ(*document_of(message), (Json{{"range", {1.0, nullptr}}}));
}

TEST(MessageCodec, NumbersThatAreNoneAreRefusedWithTheirPlace) {
  v1::Request message;
  message.mutable_range()->set_high(std::nan(""));
  EXPECT_EQ(document_of(message).error().message, "request /range/1: NaN; expected a number");
  message.mutable_range()->set_high(kInfinity);
  EXPECT_TRUE(parse_request(*document_of(message)));  // an end that is open
  message.mutable_range()->set_low(kInfinity);
  EXPECT_EQ(parse_request(*document_of(message)).error().code, ErrorCode::invalid_argument);
  message.mutable_range()->set_low(0);
  message.add_levels()->set_ratio(std::nan(""));
  EXPECT_EQ(document_of(message).error().code, ErrorCode::invalid_argument);
}

TEST(MessageCodec, FieldsOfALaterVersionAreRefused) {
  v1::Request message;
  message.mutable_range()->set_low(0);
  auto& missing = *message.mutable_missing();
  missing.GetReflection()->MutableUnknownFields(&missing)->AddVarint(99, 1);
  const auto document = document_of(message);
  ASSERT_FALSE(document);
  EXPECT_EQ(document.error().message, "request /missing: field 99 is not known to this version");
}

TEST(MessageCodec, DocumentsOfAnyOtherShapeSetNothing) {
  v1::Extraction message;
  set_message(message, Json(3));
  set_message(message, Json::array({1, 2}));
  set_message(message, {{"nobody", 1}, {"id", 7}, {"levels", nullptr}, {"state", "asleep"}, {"timings", "quick"}});
  EXPECT_EQ(message.id(), "");
  EXPECT_EQ(message.state(), v1::EXTRACTION_STATE_UNSPECIFIED);
  EXPECT_EQ(message.levels_size(), 0);
}

TEST(MessageCodec, EnumsTimesAndTextOfAnyBytes) {
  v1::Volume message;
  set_message(message,
              {{"state", "ready"}, {"created_at", "2026-01-31T12:00:00Z"}, {"name", "a\xffz"}, {"crs", nullptr}});
  EXPECT_EQ(message.state(), v1::VOLUME_STATE_READY);
  EXPECT_EQ(message.created_at().seconds(), 1769860800);
  EXPECT_EQ(message.name(), "a\xef\xbf\xbdz");
}

TEST(Shortened, CutsBetweenCharacters) {
  EXPECT_EQ(shortened("short", 10), "short");
  EXPECT_EQ(shortened(std::string(20, 'a'), 10), "aaaaaa ...");
  EXPECT_EQ(shortened("aaaaa\xc3\xa4\xc3\xa4\xc3\xa4", 10), "aaaaa ...");
}

}  // namespace
}  // namespace geosis::server::rpc
