#include "server/http/wire/head_parser.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <utility>

namespace geosis::server::http {
namespace {

constexpr std::string_view kLineEnd = "\r\n";
constexpr std::array<std::string_view, 6> kMethods = {"GET", "HEAD", "POST", "PATCH", "DELETE", "OPTIONS"};
constexpr std::array<std::string_view, 2> kMethodsNobodyTakes = {"PUT", "TRACE"};  // 405 at every path

bool is_alphanumeric(char c) {
  return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

bool is_visible(std::string_view text) {
  return std::all_of(text.begin(), text.end(), [](char c) { return c > 0x20 && c < 0x7f; });
}

bool is_host(std::string_view text) {
  constexpr std::string_view kPunctuation = ".-_:[]~%";
  return std::all_of(text.begin(), text.end(),
                     [&](char c) { return is_alphanumeric(c) || kPunctuation.find(c) != std::string_view::npos; });
}

/// The next line of the text, which is taken away with its end.
std::string_view take_line(std::string_view& text) {
  const std::size_t end = text.find(kLineEnd);
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(std::min(text.size(), line.size() + kLineEnd.size()));
  return line;
}

std::optional<Refusal> check_target(std::string_view method, std::string_view target, const HeadLimits& limits) {
  if (target.size() > limits.target_bytes) return Refusal{414, "the request's target is too long"};
  if (!is_visible(target) || target.find('#') != std::string_view::npos) {
    return Refusal{400, "the request's target holds characters that must be percent-encoded"};
  }
  if (target.front() != '/' && !(method == "OPTIONS" && target == "*")) {
    return Refusal{400, "the request's target does not begin with /"};
  }
  return std::nullopt;
}

std::optional<Refusal> read_request_line(std::string_view line, const HeadLimits& limits, Head& head) {
  const std::size_t first = line.find(' '), last = line.rfind(' ');
  const bool has_three_parts = first != std::string_view::npos && first > 0 && last > first + 1 &&
                               line.find(' ', first + 1) == last && last + 1 < line.size();
  if (!has_three_parts) return Refusal{400, "the request line is not: method, target, version"};
  const std::string_view method = line.substr(0, first), target = line.substr(first + 1, last - first - 1);
  if (!is_token(method)) return Refusal{400, "the request's method is not a token"};
  if (line.substr(last + 1) != "HTTP/1.1") return Refusal{505, "only HTTP/1.1 is spoken here"};
  const auto is_in = [method](const auto& methods) {
    return std::find(methods.begin(), methods.end(), method) != methods.end();
  };
  if (!is_in(kMethods) && !is_in(kMethodsNobodyTakes)) return Refusal{501, "the request's method is not known here"};
  head.keeps_alive = is_in(kMethods);  // what follows the others' heads is nobody's to frame
  head.method = method;
  head.target = target;
  return check_target(method, target, limits);
}

std::optional<Refusal> read_header(std::string_view line, Head& head) {
  const std::size_t colon = line.find(':');
  if (colon == std::string_view::npos || !is_token(line.substr(0, colon))) {
    return Refusal{400, "a header line has no valid name"};
  }
  const std::string_view value = trimmed(line.substr(colon + 1));
  if (!is_field_value(value)) return Refusal{400, "the value of a header holds control characters"};
  std::string name = lower_case(line.substr(0, colon));
  const auto [entry, is_new] = head.headers.try_emplace(std::move(name), value);
  if (is_new) return std::nullopt;
  if (entry->first == "host" || entry->first == "content-length" || entry->first == "transfer-encoding") {
    return Refusal{400, "header " + entry->first + " is repeated"};
  }
  entry->second.append(", ").append(value);
  return std::nullopt;
}

const std::string* find_header(const Head& head, const char* name) {
  const auto entry = head.headers.find(name);
  return entry == head.headers.end() ? nullptr : &entry->second;
}

std::optional<Refusal> read_content_length(const std::string& text, Head& head) {
  constexpr std::size_t kMostDigits = 18;  // fit into 64 bits
  const bool is_number =
      !text.empty() && std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
  if (!is_number) return Refusal{400, "Content-Length is not a number"};
  if (text.size() > kMostDigits) return Refusal{413, "Content-Length is out of all bounds"};
  std::uint64_t length = 0;
  std::from_chars(text.data(), text.data() + text.size(), length);
  head.content_length = length;
  return std::nullopt;
}

std::optional<Refusal> read_framing(Head& head) {
  const std::string* length = find_header(head, "content-length");
  const std::string* encoding = find_header(head, "transfer-encoding");
  if (length && encoding) return Refusal{400, "both Content-Length and Transfer-Encoding are given"};
  if (encoding) {
    if (lower_case(*encoding) != "chunked") return Refusal{501, "the only transfer coding known here is chunked"};
    head.is_chunked = true;
  }
  if (length) {
    if (auto refusal = read_content_length(*length, head)) return refusal;
  }
  const bool needs_length = head.method == "POST" || head.method == "PATCH";
  const bool takes_body = needs_length || head.method == "DELETE" || head.method == "PUT";
  if (head.has_body() && !takes_body) return Refusal{400, head.method + " with a body"};
  if (!length && !encoding && needs_length) {
    return Refusal{411, "neither Content-Length nor Transfer-Encoding is given"};
  }
  return std::nullopt;
}

/// Connection, Expect and Content-Encoding.
std::optional<Refusal> read_wishes(Head& head) {
  if (const std::string* connection = find_header(head, "connection")) {
    std::string_view options = *connection;
    while (!options.empty()) {
      const std::size_t comma = std::min(options.find(','), options.size());
      if (lower_case(trimmed(options.substr(0, comma))) == "close") head.keeps_alive = false;
      options.remove_prefix(std::min(options.size(), comma + 1));
    }
  }
  if (const std::string* expect = find_header(head, "expect")) {
    if (lower_case(*expect) != "100-continue") return Refusal{417, "the only expectation known here is 100-continue"};
    head.expects_continue = head.has_body();
  }
  if (const std::string* encoding = find_header(head, "content-encoding")) {
    if (lower_case(*encoding) != "identity") return Refusal{415, "bodies are taken without a content coding only"};
  }
  return std::nullopt;
}

}  // namespace

RequestLine seen_request_line(std::string_view text) {
  constexpr std::size_t kMost = 200;
  const std::string_view line = take_line(text);
  const std::size_t first = line.find(' ');
  if (first == std::string_view::npos || first > kMost || !is_token(line.substr(0, first))) return {};
  const std::string_view rest = line.substr(first + 1);
  const std::string_view path = rest.substr(0, std::min({rest.find_first_of(" ?"), kMost, rest.size()}));
  return {std::string(line.substr(0, first)),
          path.starts_with('/') && is_visible(path) ? std::string(path) : std::string()};
}

std::size_t head_length(std::string_view bytes, std::size_t searched) {
  constexpr std::string_view kHeadEnd = "\r\n\r\n";
  const std::size_t end = bytes.find(kHeadEnd, searched - std::min(searched, kHeadEnd.size() - 1));
  return end == std::string_view::npos ? end : end + kHeadEnd.size();
}

std::variant<Head, Refusal> parse_head(std::string_view text, const HeadLimits& limits) {
  if (text.size() > limits.bytes) return Refusal{431, "the request's head is too long"};
  Head head;
  if (auto refusal = read_request_line(take_line(text), limits, head)) return *std::move(refusal);
  std::size_t count = 0;
  for (std::string_view line = take_line(text); !line.empty(); line = take_line(text)) {
    if (++count > limits.headers) return Refusal{431, "the request has too many headers"};
    if (auto refusal = read_header(line, head)) return *std::move(refusal);
  }
  const std::string* host = find_header(head, "host");
  if (!host || !is_host(*host)) return Refusal{400, "there is not one valid Host"};
  if (auto refusal = read_framing(head)) return *std::move(refusal);
  if (auto refusal = read_wishes(head)) return *std::move(refusal);
  return head;
}

bool is_token(std::string_view text) {
  constexpr std::string_view kPunctuation = "!#$%&'*+-.^_`|~";
  return !text.empty() && std::all_of(text.begin(), text.end(), [&](char c) {
    return is_alphanumeric(c) || kPunctuation.find(c) != std::string_view::npos;
  });
}

bool is_field_value(std::string_view text) {
  return std::all_of(text.begin(), text.end(), [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return (byte >= 0x20 && byte != 0x7f) || byte == '\t';
  });
}

std::string lower_case(std::string_view text) {
  std::string lower(text);
  for (char& c : lower)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return lower;
}

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlank = " \t";
  const std::size_t first = std::min(text.find_first_not_of(kBlank), text.size());
  text.remove_prefix(first);
  return text.substr(0, text.find_last_not_of(kBlank) + 1);
}

}  // namespace geosis::server::http
