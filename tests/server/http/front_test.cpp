#include "server/http/front.h"

#include <chrono>
#include <deque>
#include <future>
#include <mutex>
#include <stdexcept>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <sys/resource.h>

#include "server/http/routing/error_reply.h"
#include "tests/server/http/raw_client.h"
#include "tests/server/http/test_streams.h"

namespace geosis::server::http {
namespace {

using namespace std::chrono_literals;

constexpr std::uint64_t kLargeBytes = 32 << 20;  // more than sockets buffer
constexpr std::size_t kUploadStart = 40'000;     // enough for an upload to get its thread

Reply text_reply(std::string text) {
  Reply reply;
  reply.headers = {{"Content-Type", "text/plain"}};
  reply.body = std::move(text);
  return reply;
}

Reply stream_reply(std::unique_ptr<ByteStream> stream, std::optional<std::uint64_t> length = std::nullopt) {
  Reply reply;
  reply.stream = std::move(stream);
  reply.length = length;
  return reply;
}

Reply count_body(const Request&, BodyReader& body) {
  std::string buffer(10'000, '\0');
  std::uint64_t bytes = 0;
  for (;;) {
    const auto count = body.read(std::as_writable_bytes(std::span(buffer)));
    if (!count) return error_reply(count.error());
    if (*count == 0) return text_reply(std::to_string(bytes));
    bytes += *count;
  }
}

template <class Condition>
bool holds_soon(Condition condition) {
  for (const auto end = std::chrono::steady_clock::now() + 10s; std::chrono::steady_clock::now() < end;) {
    if (condition()) return true;
    std::this_thread::sleep_for(2ms);
  }
  return false;
}

class FrontTest : public testing::Test {
 protected:
  void start(FrontOptions options = {}) {
    options.listen = "127.0.0.1:0";
    auto front = Front::start(options, routes());
    ASSERT_TRUE(front) << front.error().message;
    front_ = *std::move(front);
    port_ = front_->port();
  }

  std::string get(const std::string& path, const std::string& headers = "") {
    return ask(port_, "GET " + path, headers);
  }

  std::shared_ptr<Tap> tap_ = std::make_shared<Tap>();
  std::shared_ptr<Promise> promise_ = std::make_shared<Promise>();
  std::atomic<std::uint64_t> pulled_ = 0;
  std::promise<void> release_;
  std::shared_future<void> released_ = release_.get_future().share();
  std::atomic<int> held_ = 0, uploading_ = 0;
  std::unique_ptr<Front> front_;
  std::uint16_t port_ = 0;

 private:
  Router routes() {
    Router routes;
    routes.get("/hello", [](const Request&) { return text_reply("hello"); })
        .get("/echo/([^/]+)/([0-9]+)",
             [](const Request& request) {
               const auto word = request.query.find("word");
               return text_reply(request.captures[0] + "|" + request.captures[1] + "|" +
                                 (word == request.query.end() ? "" : word->second));
             })
        .post("/echo", [](const Request& request) { return text_reply(request.body); })
        .remove("/echo", [](const Request& request) { return text_reply("removed " + request.body); })
        .upload("/upload",
                [this](const Request& request, BodyReader& body) {
                  ++uploading_;
                  return count_body(request, body);
                })
        .upload("/ignore", [](const Request&, BodyReader&) { return text_reply("not read"); })
        .get("/throw", [](const Request&) -> Reply { throw std::runtime_error("secret"); })
        .get("/split",
             [](const Request&) {
               Reply reply;
               reply.headers = {{"A", "b\r\nC: d"}};
               return reply;
             })
        .get("/tap", [this](const Request&) { return stream_reply(std::make_unique<TapStream>(tap_)); })
        .get("/promise",
             [this](const Request&) {
               Reply reply;
               reply.pending = std::make_unique<PromisedReply>(promise_);
               return reply;
             })
        .get("/short", [](const Request&) { return stream_reply(std::make_unique<CountedStream>(10), 20); })
        .get("/counted", [](const Request&) { return stream_reply(std::make_unique<CountedStream>(200'000), 200'000); })
        .get(
            "/quick", [](const Request&) { return text_reply("slow"); },
            [](const Request& request) -> std::optional<Reply> {
              if (request.header("x-slow")) return std::nullopt;
              Reply reply;
              reply.shared = std::make_shared<const std::string>("quick as can be");
              return reply;
            })
        .get("/body", [](const Request&) { return text_reply(std::string(kLargeBytes, 'x')); })
        .get("/large",
             [this](const Request&) {
               return stream_reply(std::make_unique<CountedStream>(kLargeBytes, &pulled_), kLargeBytes);
             })
        .get("/hold", [this](const Request&) {
          ++held_;
          released_.wait();
          return text_reply("held");
        });
    return routes;
  }
};

TEST_F(FrontTest, AnswersWithCapturesAndDecodedQuery) {
  start();
  const std::string answer = get("/echo/a%20b/12?word=x%26y+z");
  EXPECT_EQ(status_of(answer), 200);
  EXPECT_EQ(body_of(answer), "a b|12|x&y z");
  EXPECT_EQ(header_of(answer, "Connection"), "close");
  EXPECT_NE(header_of(answer, "X-Request-Id"), "");
  EXPECT_NE(header_of(answer, "Date"), "");
}

TEST_F(FrontTest, KeepsTheConnectionBetweenRequests) {
  start();
  RawClient client(port_);
  for (int i = 0; i < 3; ++i) {
    client.send("GET /hello HTTP/1.1\r\nHost: a\r\n\r\n");
    const std::string answer = client.read_answer();
    EXPECT_EQ(body_of(answer), "hello");
    EXPECT_EQ(header_of(answer, "Connection"), "");
  }
}

TEST_F(FrontTest, AnswersPipelinedRequestsInOrder) {
  start();
  RawClient client(port_);
  std::string requests;
  for (int i = 0; i < 50; ++i) {
    const std::string number = std::to_string(i);
    requests += i % 2 ? "GET /echo/x/" + number + " HTTP/1.1\r\nHost: a\r\n\r\n"
                      : "POST /echo HTTP/1.1\r\nHost: a\r\nContent-Length: " + std::to_string(number.size()) +
                            "\r\n\r\n" + number;
  }
  client.send(requests);
  client.send_no_more();
  for (int i = 0; i < 50; ++i) {
    const std::string number = std::to_string(i);
    EXPECT_EQ(body_of(client.read_answer()), i % 2 ? "x|" + number + "|" : number);
  }
}

TEST_F(FrontTest, AnswersFromMemoryWithoutAHandlersThread) {
  FrontOptions options;
  options.handler_threads = 1;
  options.queued_requests = 1;
  start(options);
  RawClient running(port_);
  running.send("GET /hold HTTP/1.1\r\nHost: a\r\n\r\n");
  EXPECT_TRUE(holds_soon([&] { return held_ == 1; }));
  EXPECT_EQ(body_of(get("/quick")), "quick as can be");
  EXPECT_EQ(body_of(get("/quick", "Range: bytes=6-7\r\n")), "as");
  EXPECT_EQ(header_of(ask(port_, "HEAD /quick"), "Content-Length"), "15");
  EXPECT_EQ(body_of(ask(port_, "HEAD /quick")), "");
  release_.set_value();
  EXPECT_EQ(body_of(get("/quick", "X-Slow: 1\r\n")), "slow");
}

TEST_F(FrontTest, AnswersManyPipelinedRequestsFromMemoryOneAfterTheOther) {
  start();
  constexpr int kRequests = 20'000;
  RawClient client(port_);
  std::thread sender([&] {
    for (int i = 0; i < kRequests; ++i) client.send("GET /quick HTTP/1.1\r\nHost: a\r\n\r\n");
  });
  int answers = 0;
  while (answers < kRequests && status_of(client.read_answer()) == 200) ++answers;
  sender.join();
  EXPECT_EQ(answers, kRequests);
}

TEST_F(FrontTest, TakesHeadsByteByByte) {
  start();
  RawClient client(port_);
  for (const char c : std::string("GET /hello HTTP/1.1\r\nHost: a\r\n\r\n")) client.send(std::string(1, c));
  EXPECT_EQ(body_of(client.read_answer()), "hello");
}

TEST_F(FrontTest, AnswersHeadWithoutTheBody) {
  start();
  RawClient client(port_);
  client.send("HEAD /counted HTTP/1.1\r\nHost: a\r\n\r\nGET /hello HTTP/1.1\r\nHost: a\r\n\r\n");
  EXPECT_EQ(header_of(client.read_head(), "Content-Length"), "200000");
  EXPECT_EQ(body_of(client.read_answer()), "hello");
}

TEST_F(FrontTest, RefusesSmugglingFormsAndHangsUp) {
  start();
  const std::string hidden = "GET /hello HTTP/1.1\r\nHost: a\r\n\r\n";
  for (const char* framing :
       {"Content-Length: 5\r\nTransfer-Encoding: chunked\r\n", "Content-Length: 0\r\nContent-Length: 44\r\n",
        "Content-Length: +0\r\n", "Transfer-Encoding: chunked, identity\r\n", "Transfer-Encoding : chunked\r\n"}) {
    RawClient client(port_);
    client.send(std::string("POST /echo HTTP/1.1\r\nHost: a\r\n") + framing + "\r\n0\r\n\r\n" + hidden);
    const std::string answers = client.read_all();
    EXPECT_GE(status_of(answers), 400) << framing;
    EXPECT_EQ(header_of(answers, "Connection"), "close");
    EXPECT_EQ(answers.find("hello"), std::string::npos) << framing;
  }
}

TEST_F(FrontTest, RefusesEndlessHeads) {
  start();
  RawClient line(port_), headers(port_);
  line.send("GET /" + std::string(40'000, 'a'));
  EXPECT_EQ(status_of(line.read_all()), 414);
  headers.send("GET / HTTP/1.1\r\nA: " + std::string(40'000, 'a'));
  EXPECT_EQ(status_of(headers.read_all()), 431);
}

TEST_F(FrontTest, GivesUpOnSlowHeadsAndIdleConnections) {
  FrontOptions options;
  options.limits.head_deadline = 200ms;
  options.limits.idle_timeout = 200ms;
  start(options);
  RawClient slow(port_), silent(port_), idle(port_);
  slow.send("GET / HTTP/1.1\r\nHo");
  idle.send("GET /hello HTTP/1.1\r\nHost: a\r\n\r\n");
  EXPECT_EQ(body_of(idle.read_answer()), "hello");
  EXPECT_EQ(status_of(slow.read_all()), 408);
  EXPECT_EQ(silent.read_all(), "");
  EXPECT_EQ(idle.read_all(), "");
}

TEST_F(FrontTest, RefusesUnknownPathsAndMethods) {
  start();
  EXPECT_EQ(status_of(get("/nowhere")), 404);
  const std::string wrong = ask(port_, "DELETE /hello");
  EXPECT_EQ(status_of(wrong), 405);
  EXPECT_EQ(header_of(wrong, "Allow"), "GET, HEAD, OPTIONS");
  EXPECT_EQ(header_of(wrong, "Content-Type"), "application/problem+json");
  EXPECT_EQ(status_of(get("/echo/a%00b/1")), 400);
}

TEST_F(FrontTest, RefusesUnwantedBodiesBeforeReadingThem) {
  start();
  const std::string huge = "Content-Length: 1000000000\r\n";
  EXPECT_EQ(status_of(ask(port_, "POST /nowhere", huge)), 404);
  EXPECT_EQ(status_of(ask(port_, "PATCH /hello", huge)), 405);
  EXPECT_EQ(status_of(ask(port_, "POST /echo", huge)), 413);
  EXPECT_EQ(status_of(ask(port_, "POST /upload", "Content-Length: 999999999999999\r\n")), 413);
  EXPECT_EQ(
      status_of(ask(port_, "POST /echo", "Transfer-Encoding: chunked\r\n", "fffff\r\n" + std::string(70'000, 'a'))),
      413);
}

TEST_F(FrontTest, TakesSmallBodiesCountedAndChunked) {
  start();
  EXPECT_EQ(body_of(ask(port_, "POST /echo", "Content-Length: 2\r\n", "hi")), "hi");
  EXPECT_EQ(body_of(ask(port_, "POST /echo", "Content-Length: 0\r\n")), "");
  EXPECT_EQ(body_of(ask(port_, "POST /echo", "Transfer-Encoding: chunked\r\n", "2\r\nhi\r\n0\r\n\r\n")), "hi");
  EXPECT_EQ(body_of(ask(port_, "DELETE /echo")), "removed ");
  EXPECT_EQ(status_of(ask(port_, "POST /echo", "Transfer-Encoding: chunked\r\n", "x\r\n")), 400);
}

TEST_F(FrontTest, InvitesBodiesThatWaitForIt) {
  start();
  for (const char* path : {"/echo", "/upload"}) {
    RawClient client(port_);
    client.send(std::string("POST ") + path +
                " HTTP/1.1\r\nHost: a\r\nContent-Length: 4\r\nExpect: 100-continue\r\n\r\n");
    EXPECT_EQ(status_of(client.read_head()), 100) << path;
    client.send("four");
    EXPECT_EQ(status_of(client.read_answer()), 200) << path;
  }
}

TEST_F(FrontTest, StreamsUploadsCountedAndChunked) {
  start();
  const std::string megabyte(1 << 20, 'x');
  EXPECT_EQ(body_of(ask(port_, "POST /upload", "Content-Length: 1048576\r\n", megabyte)), "1048576");
  EXPECT_EQ(body_of(ask(port_, "POST /upload", "Content-Length: 0\r\n")), "0");
  std::string chunked;
  for (int i = 0; i < 3; ++i) chunked += "100000\r\n" + megabyte + "\r\n";
  EXPECT_EQ(body_of(ask(port_, "POST /upload", "Transfer-Encoding: chunked\r\n", chunked + "0\r\n\r\n")), "3145728");
}

TEST_F(FrontTest, TellsUploadsThatAreCutShortOrTooLong) {
  FrontOptions options;
  options.limits.upload_bytes = 1000;
  start(options);
  RawClient cut(port_);
  cut.send("POST /upload HTTP/1.1\r\nHost: a\r\nContent-Length: 10\r\n\r\n12345");
  cut.send_no_more();
  EXPECT_NE(cut.read_all().find("malformed_input"), std::string::npos);
  const std::string chunk = "7d0\r\n" + std::string(2000, 'x') + "\r\n0\r\n\r\n";
  EXPECT_NE(ask(port_, "POST /upload", "Transfer-Encoding: chunked\r\n", chunk).find("limit_exceeded"),
            std::string::npos);
}

TEST_F(FrontTest, GivesUpOnTricklingUploads) {
  FrontOptions options;
  options.limits.rate_window = 300ms;
  options.limits.head_deadline = 300ms;
  start(options);
  const std::string head = "POST /upload HTTP/1.1\r\nHost: a\r\nContent-Length: 1000000\r\n\r\n";
  RawClient early(port_), late(port_);
  early.send(head + "x");
  late.send(head + std::string(kUploadStart, 'x'));
  EXPECT_EQ(status_of(early.read_all()), 408);
  EXPECT_NE(late.read_all().find("deadline_exceeded"), std::string::npos);
}

TEST_F(FrontTest, UploadsThatSendNextToNothingTakeNoThread) {
  FrontOptions options;
  options.upload_threads = 1;
  start(options);
  std::deque<RawClient> idlers;
  for (const char* framing : {"Content-Length: 100000\r\n\r\nx", "Transfer-Encoding: chunked\r\n\r\n1\r\nx\r\n"})
    idlers.emplace_back(port_).send(std::string("POST /upload HTTP/1.1\r\nHost: a\r\n") + framing);
  EXPECT_EQ(body_of(ask(port_, "POST /upload", "Content-Length: 4\r\n", "four")), "4");
  const std::string chunks = "4\r\nfour\r\n0\r\n\r\n";
  EXPECT_EQ(body_of(ask(port_, "POST /upload", "Transfer-Encoding: chunked\r\n", chunks)), "4");
}

TEST_F(FrontTest, AnswersUploadsThatAreNotRead) {
  start();
  EXPECT_EQ(body_of(ask(port_, "POST /ignore", "Content-Length: 500000\r\n", std::string(500'000, 'x'))), "not read");
}

TEST_F(FrontTest, CapsTheNumberOfUploads) {
  FrontOptions options;
  options.upload_threads = 1;
  start(options);
  RawClient first(port_);
  first.send("POST /upload HTTP/1.1\r\nHost: a\r\nContent-Length: 40004\r\nExpect: 100-continue\r\n\r\n");
  EXPECT_EQ(status_of(first.read_head()), 100);
  first.send(std::string(kUploadStart, 'x'));
  EXPECT_TRUE(holds_soon([&] { return uploading_ == 1; }));
  const std::string refused = ask(port_, "POST /upload", "Content-Length: 0\r\n");
  EXPECT_EQ(status_of(refused), 503);
  EXPECT_NE(header_of(refused, "Retry-After"), "");
  first.send("four");
  EXPECT_EQ(body_of(first.read_answer()), "40004");
  EXPECT_EQ(status_of(ask(port_, "POST /upload", "Content-Length: 0\r\n")), 200);
}

TEST_F(FrontTest, HidesExceptionsAndInjectedHeaders) {
  start();
  for (const char* path : {"/throw", "/split"}) {
    const std::string answer = get(path);
    EXPECT_EQ(status_of(answer), 500) << path;
    EXPECT_EQ(header_of(answer, "Content-Type"), "application/problem+json");
    EXPECT_EQ(answer.find("secret"), std::string::npos);
    EXPECT_EQ(header_of(answer, "C"), "");
  }
}

TEST_F(FrontTest, ServesSingleRangesOfStreams) {
  start();
  const std::string answer = get("/counted", "Range: bytes=100000-100009\r\n");
  EXPECT_EQ(status_of(answer), 206);
  EXPECT_EQ(header_of(answer, "Content-Range"), "bytes 100000-100009/200000");
  EXPECT_EQ(body_of(answer), counted_text(100'000, 10));
  EXPECT_EQ(status_of(get("/counted", "Range: bytes=200000-\r\n")), 416);
}

TEST_F(FrontTest, WakesWaitingStreamsByTheirBell) {
  start();
  RawClient client(port_);
  client.send("GET /tap HTTP/1.1\r\nHost: a\r\n\r\n");
  EXPECT_EQ(header_of(client.read_head(), "Transfer-Encoding"), "chunked");
  for (const char* text : {"one", "two", "three"}) {
    tap_->pour(text);
    EXPECT_NE(client.read_until(text).find(text), std::string::npos);
  }
  tap_->pour("", true);
  EXPECT_EQ(client.read_until("0\r\n\r\n"), "\r\n0\r\n\r\n");
  client.send("GET /hello HTTP/1.1\r\nHost: a\r\n\r\n");
  EXPECT_EQ(body_of(client.read_answer()), "hello");
}

TEST_F(FrontTest, DestroysTheStreamWhenItsReaderLeaves) {
  start();
  RawClient client(port_);
  client.send("GET /tap HTTP/1.1\r\nHost: a\r\n\r\n");
  client.read_head();
  EXPECT_FALSE(tap_->is_destroyed);
  client.close();
  EXPECT_TRUE(holds_soon([&] { return tap_->is_destroyed.load(); }));
  tap_->pour("late");  // a bell that rings after its stream's end disturbs nobody
  EXPECT_EQ(body_of(get("/hello")), "hello");
}

TEST_F(FrontTest, SaysAStreamsIdleTextWhileNothingIsThere) {
  FrontOptions options;
  options.limits.quiet_time = 100ms;
  tap_->idle_text = ":";
  start(options);
  RawClient client(port_);
  client.send("GET /tap HTTP/1.1\r\nHost: a\r\n\r\n");
  client.read_head();
  EXPECT_EQ(client.read_until("1\r\n:\r\n1\r\n:\r\n"), "1\r\n:\r\n1\r\n:\r\n");
  tap_->pour("news", true);
  EXPECT_TRUE(client.read_until("0\r\n\r\n").ends_with("4\r\nnews\r\n0\r\n\r\n"));
}

TEST_F(FrontTest, PendingAnswersHoldNoHandlerThread) {
  FrontOptions options;
  options.handler_threads = 1;
  options.queued_requests = 1;
  start(options);
  std::deque<RawClient> clients;
  for (int i = 0; i < 50; ++i) {
    clients.emplace_back(port_).send("GET /promise HTTP/1.1\r\nHost: a\r\n\r\n");
    EXPECT_TRUE(holds_soon([&] { return body_of(get("/hello")) == "hello"; }));
  }
  promise_->keep();  // the bell of the last; the others are asked in their turn
  for (RawClient& client : clients) EXPECT_EQ(body_of(client.read_answer()), "kept");
  for (RawClient& client : clients) {
    client.send("GET /hello HTTP/1.1\r\nHost: a\r\n\r\n");
    EXPECT_EQ(body_of(client.read_answer()), "hello");
  }
}

TEST_F(FrontTest, PendingAnswersComeAtTheirDeadline) {
  start();
  promise_->time = 150ms;
  EXPECT_EQ(body_of(get("/promise")), "late");
}

TEST_F(FrontTest, ForgetsPendingAnswersOfClientsThatLeave) {
  start();
  RawClient client(port_);
  client.send("GET /promise HTTP/1.1\r\nHost: a\r\n\r\n");
  EXPECT_TRUE(holds_soon([&] {
    const std::lock_guard lock(promise_->mutex);
    return promise_->bell != nullptr;
  }));
  client.close();
  EXPECT_TRUE(holds_soon([&] { return promise_->is_destroyed.load(); }));
  promise_->keep();  // a bell that rings for nobody
  EXPECT_EQ(body_of(get("/hello")), "hello");
}

/// Remembers what it is told.
class Bystander final : public Middleware {
 public:
  std::optional<Refusal> admit(Request&) override { return std::nullopt; }
  void answered(const Answered& answered) override {
    const std::lock_guard lock(mutex_);
    told_.push_back(answered);
  }
  std::vector<Answered> told() const {
    const std::lock_guard lock(mutex_);
    return told_;
  }

 private:
  mutable std::mutex mutex_;
  std::vector<Answered> told_;
};

TEST_F(FrontTest, TellsOfClientsThatLeaveBeforeTheirPendingAnswer) {
  Bystander bystander;
  FrontOptions options;
  options.middleware = &bystander;
  start(options);
  RawClient leaver(port_), stayer(port_);
  leaver.send("GET /promise HTTP/1.1\r\nHost: a\r\nX-Request-Id: leaver\r\n\r\n");
  EXPECT_TRUE(holds_soon([&] {
    const std::lock_guard lock(promise_->mutex);
    return promise_->bell != nullptr;
  }));
  EXPECT_TRUE(bystander.told().empty());
  leaver.close();
  ASSERT_TRUE(holds_soon([&] { return bystander.told().size() == 1; }));
  const Answered left = bystander.told().front();
  EXPECT_EQ(left.status, 499);
  EXPECT_EQ(left.request_id + " " + left.route, "leaver /promise");
  EXPECT_EQ(left.bytes_out, 0U);
  EXPECT_FALSE(left.is_complete);
  EXPECT_GT(left.duration.count(), 0);
  stayer.send("GET /promise HTTP/1.1\r\nHost: a\r\n\r\n");
  promise_->keep();
  EXPECT_EQ(body_of(stayer.read_answer()), "kept");
  ASSERT_TRUE(holds_soon([&] { return bystander.told().size() == 2; }));
  EXPECT_EQ(bystander.told().back().status, 200);
  EXPECT_TRUE(bystander.told().back().is_complete);
  front_.reset();  // before its middleware
}

TEST_F(FrontTest, BreaksTheConnectionWhenAStreamFailsOrIsShort) {
  start();
  tap_->fails = true;
  const std::string failed = get("/tap"), cut = get("/short");
  EXPECT_EQ(status_of(failed), 200);
  EXPECT_EQ(failed.find("0\r\n\r\n"), std::string::npos);
  EXPECT_EQ(header_of(cut, "Content-Length"), "20");
  EXPECT_EQ(body_of(cut).size(), 10U);
}

TEST_F(FrontTest, SlowReadersHoldNoHandlerThreadAndAreNotReadAhead) {
  FrontOptions options;
  options.handler_threads = 1;
  start(options);
  std::deque<RawClient> readers;
  for (int i = 0; i < 5; ++i) readers.emplace_back(port_, 4096).send("GET /large HTTP/1.1\r\nHost: a\r\n\r\n");
  for (RawClient& reader : readers) EXPECT_EQ(status_of(reader.read_head()), 200);
  EXPECT_EQ(body_of(get("/hello")), "hello");
  EXPECT_LT(pulled_, 5 * kLargeBytes);
}

TEST_F(FrontTest, DropsReadersBelowTheMinimumRate) {
  FrontOptions options;
  options.limits.rate_window = 300ms;
  start(options);
  RawClient client(port_, 4096);
  client.send("GET /large HTTP/1.1\r\nHost: a\r\n\r\n");
  std::this_thread::sleep_for(800ms);
  EXPECT_LT(client.read_all().size(), kLargeBytes);
}

TEST_F(FrontTest, HoldsOnlySoManyBytesForReadersWhoTakeTheirTime) {
  FrontOptions options;
  options.limits.held_bytes = kLargeBytes + 1000;
  start(options);
  RawClient slow(port_, 4096);
  slow.send("GET /body HTTP/1.1\r\nHost: a\r\n\r\n");
  EXPECT_EQ(status_of(slow.read_head()), 200);
  EXPECT_EQ(status_of(get("/body")), 503);
  EXPECT_EQ(body_of(get("/hello")), "hello");
  slow.close();
  EXPECT_TRUE(holds_soon([&] { return status_of(get("/body")) == 200; }));
}

TEST_F(FrontTest, DropsReadersWhoDoNotTakeAHeldBodyInTime) {
  FrontOptions options;
  options.limits.rate_window = 300ms;
  options.limits.bytes_per_second = 1;
  options.limits.hold_time = 1s;
  start(options);
  RawClient streaming(port_, 4096), holding(port_, 4096);
  streaming.send("GET /large HTTP/1.1\r\nHost: a\r\n\r\n");
  holding.send("GET /body HTTP/1.1\r\nHost: a\r\n\r\n");
  for (int i = 0; i < 8; ++i) {
    streaming.read_bytes(40'000);
    holding.read_bytes(40'000);
    std::this_thread::sleep_for(100ms);
  }
  EXPECT_LT(holding.read_all().size(), kLargeBytes / 2);
  EXPECT_GT(streaming.read_all().size(), kLargeBytes / 2);
}

TEST_F(FrontTest, DeliversLargeStreamsWhole) {
  start();
  const std::string answer = get("/large");
  EXPECT_TRUE(body_of(answer) == counted_text(0, kLargeBytes));
}

TEST_F(FrontTest, HoldsManyIdleConnections) {
  start();
  std::deque<RawClient> idle;
  for (int i = 0; i < 200; ++i) idle.emplace_back(port_);
  EXPECT_EQ(body_of(get("/hello")), "hello");
  idle.back().send("GET /hello HTTP/1.1\r\nHost: a\r\n\r\n");
  EXPECT_EQ(body_of(idle.back().read_answer()), "hello");
}

TEST_F(FrontTest, CapsConnectionsOfOnePeer) {
  FrontOptions options;
  options.limits.connections_per_peer = 2;
  start(options);
  RawClient first(port_), second(port_);
  for (RawClient* busy : {&first, &second}) {
    busy->send("GET /tap HTTP/1.1\r\nHost: a\r\n\r\n");
    EXPECT_EQ(status_of(busy->read_head()), 200);
  }
  const std::string refused = RawClient(port_).read_all();
  EXPECT_EQ(status_of(refused), 503);
  EXPECT_NE(header_of(refused, "Retry-After"), "");
  second.close();
  EXPECT_TRUE(holds_soon([&] { return status_of(get("/hello")) == 200; }));
}

TEST_F(FrontTest, EndsIdleConnectionsForNewOnes) {
  FrontOptions options;
  options.limits.connections = 3;
  start(options);
  std::deque<RawClient> idle;
  for (int i = 0; i < 3; ++i) {
    idle.emplace_back(port_).send("GET /hello HTTP/1.1\r\nHost: a\r\n\r\n");
    EXPECT_EQ(body_of(idle.back().read_answer()), "hello");
  }
  RawClient newcomer(port_);
  newcomer.send("GET /hello HTTP/1.1\r\nHost: a\r\n\r\n");
  EXPECT_EQ(body_of(newcomer.read_answer()), "hello");
  EXPECT_TRUE(idle[0].is_closed_within(5s));
  idle[2].send("GET /hello HTTP/1.1\r\nHost: a\r\n\r\n");
  EXPECT_EQ(body_of(idle[2].read_answer()), "hello");
}

TEST_F(FrontTest, RefusesRequestsBeyondTheQueue) {
  FrontOptions options;
  options.handler_threads = 1;
  options.queued_requests = 1;
  start(options);
  const std::string request = "GET /hold HTTP/1.1\r\nHost: a\r\n\r\n";
  RawClient running(port_), queued(port_);
  running.send(request);
  EXPECT_TRUE(holds_soon([&] { return held_ == 1; }));
  queued.send(request);
  EXPECT_TRUE(holds_soon([&] { return status_of(get("/hello")) == 503; }));
  release_.set_value();
  EXPECT_EQ(body_of(running.read_answer()), "held");
}

TEST_F(FrontTest, SurvivesDescriptorExhaustion) {
  start();
  rlimit before{};
  getrlimit(RLIMIT_NOFILE, &before);
  {
    std::deque<Descriptor> hoard;
    const rlimit tight{256, before.rlim_max};
    setrlimit(RLIMIT_NOFILE, &tight);
    for (Descriptor next(::dup(0)); next.is_open(); next = Descriptor(::dup(0))) hoard.push_back(std::move(next));
    hoard.pop_back();  // one for the client, none for its other end
    RawClient refused(port_);
    EXPECT_TRUE(refused.is_closed_within(5s));
  }
  setrlimit(RLIMIT_NOFILE, &before);
  EXPECT_EQ(body_of(get("/hello")), "hello");
}

/// Remembers what it is told.
class Recorder final : public Middleware {
 public:
  std::optional<Refusal> admit(Request&) override { return std::nullopt; }
  void answered(const Answered& answered) override {
    const std::lock_guard lock(mutex_);
    told_[answered.path] = answered;
    ++count_;
  }
  Answered of(const std::string& path) {
    const std::lock_guard lock(mutex_);
    return told_[path];
  }
  int count() {
    const std::lock_guard lock(mutex_);
    return count_;
  }

 private:
  std::mutex mutex_;
  std::map<std::string, Answered> told_;
  int count_ = 0;
};

TEST_F(FrontTest, TellsTheMiddlewareOfEveryRequestOnce) {
  Recorder recorder;
  FrontOptions options;
  options.middleware = &recorder;
  start(options);
  const std::string counted = get("/counted");
  ask(port_, "POST /upload", "Content-Length: 5\r\n", "12345");
  ask(port_, "BROKEN");
  {
    RawClient client(port_);
    client.send("GET /tap HTTP/1.1\r\nHost: a\r\n\r\n");
    client.read_head();
  }
  ASSERT_TRUE(holds_soon([&] { return recorder.count() == 4; })) << recorder.count();
  EXPECT_EQ(recorder.of("/counted").bytes_out, counted.size());
  EXPECT_TRUE(recorder.of("/counted").is_complete);
  EXPECT_EQ(recorder.of("/upload").bytes_in, 5U);
  EXPECT_EQ(recorder.of("").status, 400);  // of what was no request
  EXPECT_FALSE(recorder.of("/tap").is_complete);
  front_.reset();  // before what it tells
  EXPECT_EQ(recorder.count(), 4);
}

TEST_F(FrontTest, DrainFinishesRunningStreamsAndTakesNoMore) {
  start();
  RawClient streaming(port_), idle(port_);
  streaming.send("GET /tap HTTP/1.1\r\nHost: a\r\n\r\n");
  streaming.read_head();
  EXPECT_FALSE(front_->drain(50ms));
  EXPECT_TRUE(idle.is_closed_within(5s));
  EXPECT_EQ(RawClient(port_).read_all(), "");
  tap_->pour("the end", true);
  EXPECT_NE(streaming.read_until("0\r\n\r\n").find("the end"), std::string::npos);
  streaming.close();
  EXPECT_TRUE(front_->drain(5s));
}

TEST_F(FrontTest, DrainEndsPendingAnswersThatCanEndEarly) {
  start();
  promise_->can_end_early = true;
  RawClient client(port_);
  client.send("GET /promise HTTP/1.1\r\nHost: a\r\n\r\n");
  EXPECT_TRUE(holds_soon([&] {
    const std::lock_guard lock(promise_->mutex);
    return promise_->bell != nullptr;
  }));
  EXPECT_TRUE(front_->drain(5s));
  EXPECT_EQ(body_of(client.read_all()), "late");
}

TEST_F(FrontTest, StopBreaksUploadsAndStreams) {
  start();
  RawClient uploading(port_), streaming(port_);
  uploading.send("POST /upload HTTP/1.1\r\nHost: a\r\nContent-Length: 50000\r\n\r\n" + std::string(kUploadStart, 'x'));
  EXPECT_TRUE(holds_soon([&] { return uploading_ == 1; }));
  streaming.send("GET /tap HTTP/1.1\r\nHost: a\r\n\r\n");
  streaming.read_head();
  front_->stop();
  EXPECT_TRUE(tap_->is_destroyed);
  EXPECT_TRUE(uploading.is_closed_within(5s));
}

TEST(StartFront, RefusesBadAddressesAndTakenPorts) {
  EXPECT_EQ(Front::start({.listen = "here"}, Router()).error().code, ErrorCode::invalid_argument);
  const auto first = Front::start({.listen = "127.0.0.1:0"}, Router());
  ASSERT_TRUE(first);
  const std::string taken = "127.0.0.1:" + std::to_string((*first)->port());
  EXPECT_EQ(Front::start({.listen = taken}, Router()).error().code, ErrorCode::unavailable);
}

}  // namespace
}  // namespace geosis::server::http
