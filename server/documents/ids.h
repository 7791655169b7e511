#pragma once

#include <string>
#include <string_view>

#include "engine/volume/formats/import.h"
#include "server/documents/json_text.h"

namespace geosis::server {

/// Content names: 64 hexadecimal digits. The same file read with the same options has the same volume id on every
/// machine, whether an option was given or found.
std::string volume_id(const VolumeDescription& volume);

/// 64 lower-case hexadecimal digits: what ids look like.
bool is_id(const std::string& text);

/// request          the canonical form, request_document().
/// result_version   kResultVersion of the engine that computes it.
std::string extraction_id(std::string_view volume_id, const Json& request, int result_version);

}  // namespace geosis::server
