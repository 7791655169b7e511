#include "server/http/dispatcher.h"

#include <gtest/gtest.h>

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

TEST(Dispatcher, GivesEveryRequestAnIdOfItsOwn) {
  const Dispatcher dispatcher = dispatcher_for({});
  EXPECT_NE(header_of(answer_of(dispatcher, "GET", "/things/a"), "X-Request-Id"),
            header_of(answer_of(dispatcher, "GET", "/things/a"), "X-Request-Id"));
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
