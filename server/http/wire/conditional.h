#pragma once

#include "server/http/routing/exchange.h"

namespace geosis::server::http {

/// Turns a 200 answer to GET or HEAD into what its conditions ask for: 304 when If-None-Match names its ETag, 206 or
/// 416 for a single byte range of a body of known length (If-Range must name its strong ETag). Several ranges, other
/// units and malformed ones are ignored, as RFC 9110 allows: the whole body is sent once, never multiplied.
void apply_conditions(const Request& request, Reply& reply);

}  // namespace geosis::server::http
