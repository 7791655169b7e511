#pragma once

#include <string>
#include <vector>

#include "server/http/routing/exchange.h"

namespace geosis::server::http {

/// Web pages of other origins that may use this service.
struct CorsOptions {
  std::vector<std::string> origins;  ///< "https://host:port"; "*" lets every page read (GET, HEAD), and no more
};

/// Adds what the page's browser needs to hand the answer over, if its origin may have it.
void apply_cors(const CorsOptions& options, const Request& request, Reply& reply);

/// The answer to OPTIONS: Allow, and for a preflight of an allowed origin its permissions.
///
/// allowed   the path's methods, comma separated.
Reply options_reply(const CorsOptions& options, const Request& request, const std::string& allowed);

}  // namespace geosis::server::http
