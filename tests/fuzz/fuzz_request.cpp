// Any text as a request: whatever is accepted has a canonical form that means the same and stays as it is.

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "server/documents/json_text.h"
#include "server/documents/request.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace geosis::server;
  const auto document = parse_json(std::string_view(reinterpret_cast<const char*>(data), size));
  if (!document) return 0;
  if (!parse_json(document_text(*document))) std::abort();
  const auto options = parse_request(*document);
  if (!options) return 0;
  const auto canonical = request_document(*options, {64, 64, 64});
  const auto again = parse_request(parse_json(canonical_text(canonical)).value());
  if (!again || canonical_text(request_document(*again, {64, 64, 64})) != canonical_text(canonical)) std::abort();
  return 0;
}
