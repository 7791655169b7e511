#include "server/http/routing/dispatcher.h"

#include <gtest/gtest.h>

#include "server/net/request_ids.h"

namespace geosis::server::http {
namespace {

constexpr const char* kPage = "https://viewer.example";

Dispatcher dispatcher_for(std::vector<std::string> origins) {
  Router routes;
  const auto answer = [](const Request& request) {
    Reply reply;
    reply.body = request.method + " " + request.path;
    return reply;
  };
  routes.get("/things/([^/]+)", answer).remove("/things/([^/]+)", answer).get("/things/.*", answer);
  return Dispatcher(std::move(routes), {std::move(origins)});
}

Reply answer_of(const Dispatcher& dispatcher, const std::string& method, const std::string& target,
                std::map<std::string, std::string> headers = {}) {
  Head head;
  head.method = method;
  head.target = target;
  head.headers = std::move(headers);
  return dispatcher.run(dispatcher.resolve(head));
}

std::string header_of(const Reply& reply, const std::string& wanted) {
  for (const auto& [name, value] : reply.headers)
    if (name == wanted) return value;
  return "";
}

TEST(Dispatcher, LetsGetHandlersAnswerHead) {
  EXPECT_EQ(answer_of(dispatcher_for({}), "HEAD", "/things/a").body, "HEAD /things/a");
}

TEST(Dispatcher, TellsTheMethodsOfAPath) {
  const Dispatcher dispatcher = dispatcher_for({});
  EXPECT_EQ(header_of(answer_of(dispatcher, "PATCH", "/things/a"), "Allow"), "DELETE, GET, HEAD, OPTIONS");
  const Reply options = answer_of(dispatcher, "OPTIONS", "/things/a");
  EXPECT_EQ(options.status, 204);
  EXPECT_EQ(header_of(options, "Allow"), "DELETE, GET, HEAD, OPTIONS");
  EXPECT_EQ(answer_of(dispatcher, "OPTIONS", "*").status, 204);
  EXPECT_EQ(answer_of(dispatcher, "OPTIONS", "/nothing").status, 404);
}

TEST(Dispatcher, LetsNoCacheShareWhatAKeyOpened) {
  Router routes;
  routes.get("/level", [](const Request&) {
    Reply reply;
    reply.headers = {{"Cache-Control", "public, max-age=31536000, immutable"}};
    return reply;
  });
  const Dispatcher dispatcher(std::move(routes), {});
  EXPECT_EQ(header_of(answer_of(dispatcher, "GET", "/level"), "Cache-Control"), "public, max-age=31536000, immutable");
  EXPECT_EQ(header_of(answer_of(dispatcher, "GET", "/level", {{"authorization", "Bearer k"}}), "Cache-Control"),
            "private, max-age=31536000, immutable");
}

TEST(Dispatcher, GivesEveryRequestAnIdOfItsOwn) {
  const Dispatcher dispatcher = dispatcher_for({});
  EXPECT_NE(header_of(answer_of(dispatcher, "GET", "/things/a"), "X-Request-Id"),
            header_of(answer_of(dispatcher, "GET", "/things/a"), "X-Request-Id"));
}

TEST(Dispatcher, TakesASaneIdOfTheClientAndNoOther) {
  const Dispatcher dispatcher = dispatcher_for({});
  const auto id_for = [&](const std::string& stated) {
    return header_of(answer_of(dispatcher, "GET", "/things/a", {{"x-request-id", stated}}), "X-Request-Id");
  };
  EXPECT_EQ(id_for("Job_7.a-b"), "Job_7.a-b");
  EXPECT_EQ(id_for(std::string(128, 'a')), std::string(128, 'a'));
  for (const std::string& bad : std::vector<std::string>{"", "a b", "a\"b", std::string(129, 'a')}) {
    EXPECT_NE(id_for(bad), bad);
    EXPECT_FALSE(id_for(bad).empty());
  }
}

TEST(TraceIdOf, IsThatOfAValidTraceparentOnly) {
  const auto trace_of = [](const std::string& header) { return trace_id_of(header); };
  const std::string trace = "4bf92f3577b34da6a3ce929d0e0e4736";
  EXPECT_EQ(trace_of("00-" + trace + "-00f067aa0ba902b7-01"), trace);
  EXPECT_EQ(trace_of("01-" + trace + "-00f067aa0ba902b7-01-more"), trace);
  EXPECT_EQ(trace_of("00-" + trace + "-00f067aa0ba902b7-01-more"), "");
  EXPECT_EQ(trace_of("ff-" + trace + "-00f067aa0ba902b7-01"), "");
  EXPECT_EQ(trace_of("00-" + std::string(32, '0') + "-00f067aa0ba902b7-01"), "");
  EXPECT_EQ(trace_of("00-" + trace + "-0000000000000000-01"), "");
  EXPECT_EQ(trace_of("00-4BF92F3577B34DA6A3CE929D0E0E4736-00f067aa0ba902b7-01"), "");
  EXPECT_EQ(trace_of("00-4bf9"), "");
}

/// Refuses what has no key, and remembers what it is told.
class Doorkeeper final : public Middleware {
 public:
  std::optional<Refusal> admit(Request& request) override {
    if (request.header("x-key") == nullptr) return Refusal{401, "no key"};
    request.tenant = *request.header("x-key");
    return std::nullopt;
  }
  void answered(const Answered& answered) override { told.push_back(answered); }
  int retry_after_seconds() const override { return 17; }

  std::vector<Answered> told;
};

Dispatcher guarded_dispatcher(Doorkeeper& keeper) {
  Router routes;
  routes.get("/things/([0-9]+)\\.(a|b)", [](const Request& request) {
    Reply reply;
    reply.body = request.tenant;
    return reply;
  });
  return Dispatcher(std::move(routes), {}, &keeper);
}

TEST(Dispatcher, AsksTheMiddlewareBeforeTheHandler) {
  Doorkeeper keeper;
  const Dispatcher dispatcher = guarded_dispatcher(keeper);
  const Reply refused = answer_of(dispatcher, "GET", "/things/1.a");
  EXPECT_EQ(refused.status, 401);
  EXPECT_NE(refused.body.find("unauthenticated"), std::string::npos);
  EXPECT_FALSE(header_of(refused, "WWW-Authenticate").empty());
  EXPECT_EQ(answer_of(dispatcher, "GET", "/things/1.a", {{"x-key", "blue"}}).body, "blue");
  // What nobody answers needs no key.
  EXPECT_EQ(answer_of(dispatcher, "GET", "/nothing").status, 404);
  EXPECT_EQ(answer_of(dispatcher, "OPTIONS", "/things/1.a").status, 204);
}

TEST(Dispatcher, SaysWhenToComeAgainAsTheMiddlewareDoes) {
  Doorkeeper keeper;
  const Dispatcher dispatcher = guarded_dispatcher(keeper);
  EXPECT_EQ(header_of(dispatcher.refuse({}, {503, "full"}), "Retry-After"), "17");
  EXPECT_EQ(header_of(dispatcher.refuse({}, {429, "too much"}), "Retry-After"), "17");
  EXPECT_EQ(header_of(dispatcher.refuse({}, {404, "nothing"}), "Retry-After"), "");
}

TEST(Dispatcher, TellsTheMiddlewareWhatBecameOfARequest) {
  Doorkeeper keeper;
  const Dispatcher dispatcher = guarded_dispatcher(keeper);
  Reply reply = answer_of(dispatcher, "GET", "/things/1.b", {{"x-key", "blue"}, {"x-request-id", "r1"}});
  ASSERT_TRUE(reply.on_written);
  EXPECT_TRUE(keeper.told.empty());
  reply.on_written(77, false);
  ASSERT_EQ(keeper.told.size(), 1U);
  const Answered& told = keeper.told.front();
  EXPECT_EQ(told.method + " " + told.route + " " + told.request_id + " " + told.tenant, "GET /things/*.* r1 blue");
  EXPECT_EQ(told.status, 200);
  EXPECT_EQ(told.bytes_out, 77U);
  EXPECT_FALSE(told.is_complete);
}

TEST(Dispatcher, MatchesLongPathsWithoutEnd) {
  const std::string path = "/things/" + std::string(3900, 'a') + "/" + std::string(3900, 'b');
  EXPECT_EQ(answer_of(dispatcher_for({}), "GET", path).body, "GET " + path);
}

TEST(Cors, NamesOnlyAllowedOrigins) {
  const Dispatcher dispatcher = dispatcher_for({kPage});
  const Reply allowed = answer_of(dispatcher, "GET", "/things/a", {{"origin", kPage}});
  EXPECT_EQ(header_of(allowed, "Access-Control-Allow-Origin"), kPage);
  EXPECT_EQ(header_of(allowed, "Vary"), "Origin");
  const Reply other = answer_of(dispatcher, "GET", "/things/a", {{"origin", "https://evil.example"}});
  EXPECT_EQ(header_of(other, "Access-Control-Allow-Origin"), "");
  EXPECT_EQ(header_of(other, "Vary"), "Origin");
}

TEST(Cors, AnswersPreflights) {
  const Reply reply = answer_of(dispatcher_for({kPage}), "OPTIONS", "/things/a",
                                {{"origin", kPage}, {"access-control-request-method", "DELETE"}});
  EXPECT_EQ(reply.status, 204);
  EXPECT_EQ(header_of(reply, "Access-Control-Allow-Origin"), kPage);
  EXPECT_EQ(header_of(reply, "Access-Control-Allow-Methods"), "DELETE");
}

TEST(Cors, LetsEveryPageReadButNotWriteUnderAStar) {
  const Dispatcher dispatcher = dispatcher_for({"*"});
  EXPECT_EQ(header_of(answer_of(dispatcher, "GET", "/things/a", {{"origin", kPage}}), "Access-Control-Allow-Origin"),
            "*");
  for (const char* method : {"DELETE", "POST"}) {
    const Reply preflight =
        answer_of(dispatcher, "OPTIONS", "/things/a", {{"origin", kPage}, {"access-control-request-method", method}});
    EXPECT_EQ(header_of(preflight, "Access-Control-Allow-Origin"), "");
    EXPECT_EQ(header_of(preflight, "Access-Control-Allow-Methods"), "");
  }
}

}  // namespace
}  // namespace geosis::server::http
