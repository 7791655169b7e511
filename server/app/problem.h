#pragma once

#include "engine/base/result.h"
#include "server/documents/json_text.h"

namespace geosis::server {

/// The problem document (RFC 9457) of an error: type, title, status, detail, code, and the JSON pointer of a field when
/// the message names one ("request /range: ...").
Json problem_document(const Error& error);

}  // namespace geosis::server
