#pragma once

#include <string>

#include "server/http/exchange.h"

namespace geosis::server::http {

/// The client's X-Request-Id where it is 1 to 128 of A-Z a-z 0-9 . _ -, else one that is unique in this process and
/// unlikely elsewhere.
std::string request_id_of(const Request& request);

/// The trace id of a valid W3C traceparent header, 32 hexadecimal digits; else empty.
std::string trace_id_of(const Request& request);

}  // namespace geosis::server::http
