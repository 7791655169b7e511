#pragma once

#include <string_view>

#include "engine/base/result.h"

namespace geosis::server {

/// True for a segment of a key: 1 .. 255 bytes of [A-Za-z0-9._-], neither "." nor "..".
bool is_key_segment(std::string_view name);

/// Refuses what is not a BlobKey (see blob_store.h). A key that passes cannot lead out of a store's folder.
///
/// errors   invalid_argument.
Result<void> check_key(std::string_view key);

/// Refuses what does not start keys: "", or segments each followed by "/".
///
/// errors   invalid_argument.
Result<void> check_prefix(std::string_view prefix);

}  // namespace geosis::server
