// Any bytes as the target of a request: what matches a pattern is made of its captures.

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "server/http/wire/target_matcher.h"

namespace {

const geosis::server::http::TargetMatcher& matcher() {
  static const auto made = [] {
    geosis::server::http::TargetMatcher patterns;
    patterns.add("/v1/extractions/([^/]+)/lods/([0-9]+)\\.(drc|glb)");
    patterns.add("/v1/volumes/([^/]+)");
    patterns.add("/page/.*");
    return patterns;
  }();
  return made;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto match = matcher().match(std::string_view(reinterpret_cast<const char*>(data), size));
  if (!match) return 0;
  for (const char c : match->path) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) std::abort();
  }
  const auto& captures = match->captures;
  if (match->pattern == 0U) {
    if (match->path != "/v1/extractions/" + captures.at(0) + "/lods/" + captures.at(1) + "." + captures.at(2))
      std::abort();
  } else if (match->pattern == 1U) {
    if (match->path != "/v1/volumes/" + captures.at(0) || captures.at(0).find('/') != std::string::npos) std::abort();
  }
  return 0;
}
