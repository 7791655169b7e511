#include "server/http/wire/conditional.h"

#include <algorithm>
#include <string>

#include <gtest/gtest.h>

#include "tests/server/http/test_streams.h"

namespace geosis::server::http {
namespace {

constexpr const char* kTag = "\"abc\"";
constexpr std::uint64_t kLength = 100;

Request request_with(std::map<std::string, std::string> headers, const std::string& method = "GET") {
  Request request;
  request.method = method;
  request.headers = std::move(headers);
  return request;
}

Reply tagged_text() {
  Reply reply;
  reply.headers = {{"ETag", kTag}};
  reply.body = counted_text(0, kLength);
  return reply;
}

Reply after_conditions(const Request& request, Reply reply = tagged_text()) {
  apply_conditions(request, reply);
  return reply;
}

std::string header_of(const Reply& reply, const std::string& name) {
  const auto found = std::find_if(reply.headers.begin(), reply.headers.end(),
                                  [&](const auto& header) { return header.first == name; });
  return found == reply.headers.end() ? "" : found->second;
}

TEST(ApplyConditions, AnswersNotModifiedForAKnownTag) {
  for (const char* known : {"\"abc\"", "\"x\", \"abc\"", "W/\"abc\"", "*"}) {
    const Reply reply = after_conditions(request_with({{"if-none-match", known}}));
    EXPECT_EQ(reply.status, 304) << known;
    EXPECT_EQ(reply.body, "");
    EXPECT_EQ(header_of(reply, "ETag"), kTag);
  }
}

TEST(ApplyConditions, AnswersWholeForAnotherTag) {
  EXPECT_EQ(after_conditions(request_with({{"if-none-match", "\"abcd\", abc"}})).status, 200);
  EXPECT_EQ(after_conditions(request_with({{"if-none-match", kTag}}), Reply{}).status, 200);
}

struct RangeCase {
  const char* text;
  std::uint64_t first, count;
};

TEST(ApplyConditions, CutsSingleRangesOutOfBodiesAndStreams) {
  for (const RangeCase& range : {RangeCase{"bytes=0-0", 0, 1}, RangeCase{"bytes=10-19", 10, 10},
                                 RangeCase{"bytes=90-", 90, 10}, RangeCase{"bytes=-5", 95, 5},
                                 RangeCase{"bytes=-500", 0, 100}, RangeCase{"Bytes=99-18446744073709551614", 99, 1}}) {
    const Reply cut = after_conditions(request_with({{"range", range.text}}));
    EXPECT_EQ(cut.status, 206) << range.text;
    EXPECT_EQ(cut.body, counted_text(range.first, range.count)) << range.text;
    Reply streamed;
    streamed.stream = std::make_unique<CountedStream>(kLength);
    streamed.length = kLength;
    EXPECT_EQ(after_conditions(request_with({{"range", range.text}}), std::move(streamed)).length, range.count);
  }
}

TEST(ApplyConditions, IgnoresSeveralAndMalformedRanges) {
  for (const char* text : {"bytes=0-1,2-3", "bytes=5-4", "bytes=a-b", "bytes=-", "bytes=", "lines=0-1", "bytes=+1-2",
                           "bytes=1-18446744073709551616", "0-1"}) {
    const Reply reply = after_conditions(request_with({{"range", text}}));
    EXPECT_EQ(reply.status, 200) << text;
    EXPECT_EQ(reply.body.size(), kLength) << text;
  }
}

TEST(ApplyConditions, RefusesRangesBehindTheEndWithTheLength) {
  for (const char* text : {"bytes=100-", "bytes=100-200", "bytes=-0"}) {
    const Reply reply = after_conditions(request_with({{"range", text}}));
    EXPECT_EQ(reply.status, 416) << text;
    EXPECT_EQ(header_of(reply, "Content-Range"), "bytes */100");
  }
}

TEST(ApplyConditions, RangesOnlyOfTheVersionThatIfRangeNames) {
  EXPECT_EQ(after_conditions(request_with({{"range", "bytes=0-0"}, {"if-range", kTag}})).status, 206);
  EXPECT_EQ(after_conditions(request_with({{"range", "bytes=0-0"}, {"if-range", "\"old\""}})).status, 200);
}

TEST(ApplyConditions, LeavesOtherMethodsStatusesAndEndlessStreamsAlone) {
  const std::map<std::string, std::string> headers = {{"range", "bytes=0-0"}, {"if-none-match", kTag}};
  EXPECT_EQ(after_conditions(request_with(headers, "POST")).status, 200);
  Reply accepted = tagged_text();
  accepted.status = 202;
  EXPECT_EQ(after_conditions(request_with(headers), std::move(accepted)).status, 202);
  Reply endless;
  endless.stream = std::make_unique<CountedStream>(kLength);
  EXPECT_EQ(after_conditions(request_with(headers), std::move(endless)).status, 200);
}

}  // namespace
}  // namespace geosis::server::http
