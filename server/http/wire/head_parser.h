#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

namespace geosis::server::http {

/// The head of a request: request line and headers, with the framing they state.
struct Head {
  std::string method, target;
  std::map<std::string, std::string> headers;  ///< names in lower case; repeated ones joined with ", "
  std::optional<std::uint64_t> content_length;
  bool is_chunked = false;
  bool keeps_alive = true;
  bool expects_continue = false;

  bool has_body() const { return is_chunked || content_length.value_or(0) > 0; }
};

/// A request that is answered without being looked at further; the connection closes, for its framing is in doubt.
struct Refusal {
  int status = 400;
  std::string detail;
};

/// What a request line says, where its head is refused.
struct RequestLine {
  std::string method, path;
};

struct HeadLimits {
  std::size_t bytes = 32 * 1024;
  std::size_t target_bytes = 8000;
  std::size_t headers = 100;
};

/// Length of the head at the start of `bytes`, with its empty line; npos while it is incomplete.
///
/// searched   bytes in which an earlier call found no end: many small pieces cost no more than one.
std::size_t head_length(std::string_view bytes, std::size_t searched = 0);

/// Reads a complete head more strictly than RFC 9112 demands, so that no proxy in front can frame it otherwise: one
/// Host; at most one of Content-Length and Transfer-Encoding, once; digits only; `chunked` only; no folded lines, no
/// space before a colon, no control characters; HTTP/1.1; origin-form targets (or * for OPTIONS).
///
/// returns  the head, or 400, 411, 414, 415, 417, 431, 501, 505.
std::variant<Head, Refusal> parse_head(std::string_view text, const HeadLimits& limits = {});

/// Method and path of a head that parse_head refused, for the log: at most 200 visible characters of each, without the
/// query; empty where there is no such thing.
RequestLine seen_request_line(std::string_view text);

/// RFC 9110's token: what methods and header names are made of.
bool is_token(std::string_view text);

/// No control characters but tabs: what the value of a header may hold.
bool is_field_value(std::string_view text);

std::string lower_case(std::string_view text);

/// Without spaces and tabs at both ends.
std::string_view trimmed(std::string_view text);

}  // namespace geosis::server::http
