#pragma once

#include <optional>
#include <string_view>

#include "engine/base/result.h"
#include "server/auth/api_keys.h"

namespace geosis::server {

/// Who calls with this "Bearer KEY", if he may; the same for every door.
///
/// keys            none = anybody may do anything, as tenant `default`.
/// authorization   as the caller states it; empty = not at all.
/// writes          whether the call needs volumes:write; else volumes:read.
/// errors          unauthenticated; permission_denied.
Result<Caller> admit_caller(const std::optional<ApiKeys>& keys, std::string_view authorization, bool writes);

}  // namespace geosis::server
