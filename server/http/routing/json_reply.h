#pragma once

#include <utility>

#include "server/documents/json_text.h"
#include "server/http/routing/error_reply.h"
#include "server/http/routing/exchange.h"

namespace geosis::server::http {

inline Reply json_reply(int status, const Json& document) {
  Reply reply;
  reply.status = status;
  reply.headers = {{"Content-Type", "application/json"}, {"Cache-Control", "no-cache"}};
  reply.body = document_text(document);
  return reply;
}

/// False for a body that says it is something else than JSON: pages of other origins can send such without asking.
inline bool has_json_body(const Request& request) {
  const auto found = request.headers.find("content-type");
  return found == request.headers.end() || found->second.starts_with("application/json") ||
         found->second.starts_with("application/merge-patch+json");
}

inline Reply not_json() {
  return refusal_reply({415, "the body must be application/json"});
}

}  // namespace geosis::server::http
