#pragma once

#include "engine/pipeline/reconstruct.h"
#include "server/documents/json_text.h"

namespace geosis::server {

/// A sentence for people.
const char* text_of(EmptyReason reason);

/// {"code", "detail"}: why an extraction is done without a level; null when it has some.
Json empty_reason_document(const std::optional<EmptyReason>& reason);

}  // namespace geosis::server
