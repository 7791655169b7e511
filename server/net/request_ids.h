#pragma once

#include <string>
#include <string_view>

namespace geosis::server {

/// stated    the caller's x-request-id; empty = none.
/// returns   it where it is 1 to 128 of A-Z a-z 0-9 . _ -, else one that is unique in this process and unlikely
///           elsewhere.
std::string request_id_of(std::string_view stated);

/// The trace id of a valid W3C traceparent, 32 hexadecimal digits; else empty.
std::string trace_id_of(std::string_view traceparent);

}  // namespace geosis::server
