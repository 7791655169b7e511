#include "server/http/routing/error_reply.h"

#include <gtest/gtest.h>

#include "server/app/errors.h"
#include "server/http/wire/reply_head.h"

namespace geosis::server::http {
namespace {

Json document_of(const Reply& reply) {
  auto document = parse_json(reply.body);
  EXPECT_TRUE(document) << reply.body;
  return document ? *std::move(document) : Json::object();
}

TEST(ErrorReply, SaysWhatTheTableSays) {
  for (int code = 0; code <= static_cast<int>(ErrorCode::internal); ++code) {
    const Error error{static_cast<ErrorCode>(code), "trace 7: is bad"};
    const Reply reply = error_reply(error);
    const Json document = document_of(reply);
    EXPECT_EQ(reply.status, numbers_of(error.code).http_status);
    EXPECT_EQ(document["status"], reply.status);
    EXPECT_EQ(document["code"], name_of(error.code));
    EXPECT_EQ(document["title"], numbers_of(error.code).title);
    EXPECT_EQ(document["detail"], "trace 7: is bad");
    EXPECT_FALSE(document.contains("pointer"));
  }
}

TEST(ErrorReply, SplitsThePointerOffMessagesAboutDocuments) {
  for (const char* message : {"request /levels/0/ratio: 2; expected less", "/levels/0/ratio: 2; expected less"}) {
    const Json document = document_of(error_reply({ErrorCode::invalid_argument, message}));
    EXPECT_EQ(document["pointer"], "/levels/0/ratio");
    EXPECT_EQ(document["detail"], "2; expected less");
  }
}

TEST(ErrorReply, AddsMembers) {
  const Json document = document_of(error_reply({ErrorCode::unsupported, "no grid"}, {{"candidates", Json::array()}}));
  EXPECT_TRUE(document["candidates"].is_array());
  EXPECT_EQ(document["detail"], "no grid");
}

TEST(RefusalReply, TakesAnyBytesAndAsksToRetryLater) {
  const Reply reply = refusal_reply({503, "bad \xff byte"});
  EXPECT_EQ(document_of(reply)["code"], "unavailable");
  EXPECT_NE(reply_head(reply, {}).find("Retry-After: "), std::string::npos);
}

TEST(RefusalReply, HasTheTitleThatErrorsOfItsTypeHave) {
  EXPECT_EQ(document_of(refusal_reply({404, "nothing here"}))["title"], numbers_of(ErrorCode::not_found).title);
  EXPECT_EQ(document_of(refusal_reply({405, "not that"}))["title"], numbers_of(ErrorCode::unsupported).title);
}

}  // namespace
}  // namespace geosis::server::http
