#include "server/http/wire/head_parser.h"

#include <string>

#include <gtest/gtest.h>

namespace geosis::server::http {
namespace {

/// 200 for a head that is taken, otherwise the refusal's status.
int judge(const std::string& text) {
  const auto parsed = parse_head(text);
  const auto* refusal = std::get_if<Refusal>(&parsed);
  return refusal ? refusal->status : 200;
}

Head parsed(const std::string& text) {
  const auto result = parse_head(text);
  EXPECT_TRUE(std::holds_alternative<Head>(result)) << text;
  return std::holds_alternative<Head>(result) ? std::get<Head>(result) : Head{};
}

std::string get(const std::string& headers) {
  return "GET /a HTTP/1.1\r\nHost: here\r\n" + headers + "\r\n";
}
std::string post(const std::string& headers) {
  return "POST /a HTTP/1.1\r\nHost: here\r\n" + headers + "\r\n";
}

struct Judged {
  const char* what;
  std::string text;
  int status;
};

class Judgement : public testing::TestWithParam<Judged> {};

TEST_P(Judgement, IsAsListed) {
  EXPECT_EQ(judge(GetParam().text), GetParam().status) << GetParam().text;
}

INSTANTIATE_TEST_SUITE_P(
    ParseHead, Judgement,
    testing::Values(
        Judged{"Plain", get(""), 200}, Judged{"CountedBody", post("Content-Length: 5\r\n"), 200},
        Judged{"ChunkedBody", post("Transfer-Encoding: Chunked\r\n"), 200},
        Judged{"HostWithPort", "GET / HTTP/1.1\r\nHost: [::1]:80\r\n\r\n", 200},
        Judged{"AllOfTheServer", "OPTIONS * HTTP/1.1\r\nHost: here\r\n\r\n", 200},
        Judged{"BlankAroundValue", get("A: \t b \t\r\n"), 200}, Judged{"EmptyValue", get("A:\r\n"), 200},
        Judged{"NoHost", "GET / HTTP/1.1\r\n\r\n", 400}, Judged{"TwoHosts", get("Host: there\r\n"), 400},
        Judged{"HostIsAnAddress", "GET / HTTP/1.1\r\nHost: a/b\r\n\r\n", 400},
        Judged{"LengthAndChunked", post("Content-Length: 5\r\nTransfer-Encoding: chunked\r\n"), 400},
        Judged{"TwoLengths", post("Content-Length: 5\r\nContent-Length: 5\r\n"), 400},
        Judged{"ListOfLengths", post("Content-Length: 5, 5\r\n"), 400},
        Judged{"SignedLength", post("Content-Length: +5\r\n"), 400},
        Judged{"NegativeLength", post("Content-Length: -5\r\n"), 400},
        Judged{"HexadecimalLength", post("Content-Length: 0x5\r\n"), 400},
        Judged{"LengthWithTail", post("Content-Length: 5x\r\n"), 400},
        Judged{"EmptyLength", post("Content-Length:\r\n"), 400},
        Judged{"LengthOverflows", post("Content-Length: 18446744073709551621\r\n"), 413},
        Judged{"NoLength", post(""), 411}, Judged{"ChunkedTwice", post("Transfer-Encoding: chunked, chunked\r\n"), 501},
        Judged{"ZippedAndChunked", post("Transfer-Encoding: gzip, chunked\r\n"), 501},
        Judged{"ChunkedNotLast", post("Transfer-Encoding: chunked, gzip\r\n"), 501},
        Judged{"ChunkedTwoLines", post("Transfer-Encoding: chunked\r\nTransfer-Encoding: chunked\r\n"), 400},
        Judged{"ChunkedWithTab",
               post("Transfer-Encoding: \x0b"
                    "chunked\r\n"),
               400},
        Judged{"BodyOfGet", get("Content-Length: 5\r\n"), 400},
        Judged{"BodyOfOptions", "OPTIONS / HTTP/1.1\r\nHost: a\r\nContent-Length: 5\r\n\r\n", 400},
        Judged{"SpaceBeforeColon", post("Content-Length : 5\r\n"), 400},
        Judged{"FoldedLine", get("A: b\r\n c\r\n"), 400}, Judged{"NoColon", get("A\r\n"), 400},
        Judged{"EmptyName", get(": b\r\n"), 400}, Judged{"NameWithBrackets", get("A(b): c\r\n"), 400},
        Judged{"BareLineFeed", get("A: b\nContent-Length: 5\r\n"), 400},
        Judged{"BareReturn", get("A: b\rContent-Length: 5\r\n"), 400},
        Judged{"ZeroByte", get(std::string("A: b\0c\r\n", 8)), 400},
        Judged{"Http10", "GET / HTTP/1.0\r\nHost: a\r\n\r\n", 505}, Judged{"Http2", "PRI * HTTP/2.0\r\n\r\n", 505},
        Judged{"NoVersion", "GET /\r\nHost: a\r\n\r\n", 400},
        Judged{"TwoSpaces", "GET  / HTTP/1.1\r\nHost: a\r\n\r\n", 400},
        Judged{"FourParts", "GET / x HTTP/1.1\r\nHost: a\r\n\r\n", 400},
        Judged{"TabsForSpaces", "GET\t/\tHTTP/1.1\r\nHost: a\r\n\r\n", 400},
        Judged{"LineBeforeRequest", "\r\nGET / HTTP/1.1\r\nHost: a\r\n\r\n", 400},
        Judged{"UnknownMethod", "BREW / HTTP/1.1\r\nHost: a\r\n\r\n", 501},
        Judged{"MethodInLowerCase", "get / HTTP/1.1\r\nHost: a\r\n\r\n", 501},
        Judged{"ProxyTarget", "GET http://a/ HTTP/1.1\r\nHost: a\r\n\r\n", 400},
        Judged{"Fragment", "GET /a#b HTTP/1.1\r\nHost: a\r\n\r\n", 400},
        Judged{"TargetNotEncoded", "GET /\xc3\xa4 HTTP/1.1\r\nHost: a\r\n\r\n", 400},
        Judged{"LongTarget", "GET /" + std::string(8000, 'a') + " HTTP/1.1\r\nHost: a\r\n\r\n", 414},
        Judged{"LongHead", get("A: " + std::string(32 * 1024, 'a') + "\r\n"), 431},
        Judged{"ZippedBody", post("Content-Length: 5\r\nContent-Encoding: gzip\r\n"), 415},
        Judged{"UnknownExpectation", post("Content-Length: 5\r\nExpect: tea\r\n"), 417}),
    [](const auto& judged) { return judged.param.what; });

TEST(ParseHead, RefusesMoreThanAHundredHeaders) {
  std::string headers;
  for (int i = 0; i < 99; ++i) headers.append("A").append(std::to_string(i)).append(": b\r\n");
  EXPECT_EQ(judge(get(headers)), 200);
  EXPECT_EQ(judge(get(headers + "B: c\r\n")), 431);
}

TEST(ParseHead, TellsMethodTargetHeadersAndFraming) {
  const Head head = parsed("POST /a?b=c HTTP/1.1\r\nHOST: here\r\nContent-LENGTH: 12\r\nExpect: 100-continue\r\n\r\n");
  EXPECT_EQ(head.method, "POST");
  EXPECT_EQ(head.target, "/a?b=c");
  EXPECT_EQ(head.headers.at("host"), "here");
  EXPECT_EQ(head.content_length, 12U);
  EXPECT_TRUE(head.expects_continue);
  EXPECT_TRUE(head.keeps_alive);
}

TEST(ParseHead, JoinsRepeatedHeaders) {
  EXPECT_EQ(parsed(get("Prefer: wait=1\r\nprefer: respond-async\r\n")).headers.at("prefer"), "wait=1, respond-async");
}

TEST(ParseHead, FindsCloseAmongTheOptionsOfConnection) {
  EXPECT_FALSE(parsed(get("Connection: foo, Close\r\n")).keeps_alive);
  EXPECT_TRUE(parsed(get("Connection: closed\r\n")).keeps_alive);
}

TEST(ParseHead, KnowsMethodsThatNoPathTakes) {
  const Head head = parsed("PUT /a HTTP/1.1\r\nHost: here\r\nContent-Length: 5\r\n\r\n");
  EXPECT_EQ(head.method, "PUT");
  EXPECT_EQ(head.content_length, 5U);
  EXPECT_FALSE(head.keeps_alive);
  EXPECT_EQ(parsed("PUT /a HTTP/1.1\r\nHost: here\r\n\r\n").method, "PUT");
  EXPECT_EQ(parsed("TRACE /a HTTP/1.1\r\nHost: here\r\n\r\n").method, "TRACE");
  EXPECT_EQ(judge("TRACE /a HTTP/1.1\r\nHost: here\r\nContent-Length: 5\r\n\r\n"), 400);
  EXPECT_EQ(judge("CONNECT a:80 HTTP/1.1\r\nHost: here\r\n\r\n"), 501);
}

TEST(SeenRequestLine, IsWhatTheLogMayShow) {
  EXPECT_EQ(seen_request_line("BREW /pot?milk=1 HTTP/1.1\r\n").method, "BREW");
  EXPECT_EQ(seen_request_line("BREW /pot?milk=1 HTTP/1.1\r\n").path, "/pot");
  EXPECT_EQ(seen_request_line("GET /liv\x01"
                              "ez HTTP/1.1\r\n")
                .path,
            "");
  EXPECT_EQ(seen_request_line("GET /" + std::string(5000, 'a')).path.size(), 200U);
  EXPECT_EQ(seen_request_line("\x16\x03\x01 a b").method, "");
  EXPECT_EQ(seen_request_line("CONNECT a:80 HTTP/1.1\r\n").path, "");
  EXPECT_EQ(seen_request_line("").method, "");
}

TEST(HeadLength, FindsTheEndWhereverThePiecesWereCut) {
  const std::string text = get("A: b\r\n") + "rest";
  for (std::size_t searched = 0; searched < text.size() - 4; ++searched) {
    if (head_length(std::string_view(text).substr(0, searched)) != std::string_view::npos) continue;
    EXPECT_EQ(head_length(text, searched), text.size() - 4) << searched;
  }
}

}  // namespace
}  // namespace geosis::server::http
