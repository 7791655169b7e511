#pragma once

#include <utility>

#include "server/documents/json_text.h"
#include "server/http/exchange.h"

namespace geosis::server::http {

inline Reply json_reply(int status, const Json& document) {
  Reply reply;
  reply.status = status;
  reply.headers = {{"Content-Type", "application/json"}, {"Cache-Control", "no-cache"}};
  reply.body = document_text(document);
  return reply;
}

}  // namespace geosis::server::http
