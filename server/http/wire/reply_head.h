#pragma once

#include <string>

#include "server/http/routing/exchange.h"

namespace geosis::server::http {

/// How a reply is written, beyond what the handler said.
struct ReplyForm {
  bool is_head = false;  ///< an answer to HEAD: everything but the body
  bool closes = false;   ///< the connection ends with it
};

/// Whether every header is one line with a valid name, and status and framing are ours to write.
bool is_writable(const Reply& reply);

/// No body follows the head, whatever the reply holds.
bool is_bodiless(int status);

/// Bytes of the body, where they are known.
std::uint64_t body_length(const Reply& reply);

/// Status line, the reply's headers, Date, framing, Connection and the empty line.
std::string reply_head(const Reply& reply, const ReplyForm& form);

/// RFC 9110's words for the statuses that this service uses.
const char* status_phrase(int status);

}  // namespace geosis::server::http
