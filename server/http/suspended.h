#pragma once

#include <memory>

#include "server/http/exchange.h"
#include "server/http/reply_head.h"

namespace geosis::server::http {

/// A request whose answer is pending, and all that is needed to write it once it is there.
struct Suspended {
  Request request;
  ReplyForm form;
  std::unique_ptr<PendingReply> pending;
};

}  // namespace geosis::server::http
