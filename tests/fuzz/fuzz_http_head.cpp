// Any bytes as the head of a request: refused, or framed in one way only.

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>
#include <variant>

#include "server/http/wire/head_parser.h"

using geosis::server::http::Head;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  const std::size_t length = geosis::server::http::head_length(bytes);
  if (length == std::string_view::npos) return 0;
  const auto parsed = geosis::server::http::parse_head(bytes.substr(0, length));
  const Head* head = std::get_if<Head>(&parsed);
  if (!head) return 0;
  if (head->is_chunked && head->content_length) std::abort();
  if (!head->headers.contains("host")) std::abort();
  for (const auto& [name, value] : head->headers) {
    if (!geosis::server::http::is_token(name) || !geosis::server::http::is_field_value(value)) std::abort();
  }
  return 0;
}
