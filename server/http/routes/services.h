#pragma once

#include <functional>

#include "server/app/services.h"
#include "server/http/routing/exchange.h"
#include "server/http/routing/reply_cache.h"

namespace geosis::server::http {

/// The use cases that the routes open to HTTP, and the answers that it keeps. Outlives the front.
struct Services : server::Services {
  ReplyCache& kept;
};

/// The services of the tenant that a request comes from.
using ServicesOf = std::function<Services(const Request&)>;

}  // namespace geosis::server::http
