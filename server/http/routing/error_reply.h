#pragma once

#include <string>

#include "engine/base/result.h"
#include "server/documents/json_text.h"
#include "server/http/routing/exchange.h"
#include "server/http/wire/head_parser.h"

namespace geosis::server::http {

/// An error as application/problem+json: type, title, status, detail, code, and `pointer` when the message names a
/// place in a JSON document ("request /range: ..."). Status and title come from the table in server/app/errors.h.
///
/// more   an object whose members are added, for example the candidates of a refused survey.
Reply error_reply(const Error& error, const Json& more = Json::object());

/// A refusal by the protocol itself, in the same form. 503 and 429 carry Retry-After.
Reply refusal_reply(const Refusal& refusal);

}  // namespace geosis::server::http
