#pragma once

#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>

#include "engine/base/result.h"
#include "server/http/routing/exchange.h"

namespace geosis::server::http {

/// The header's value; empty when it was not sent. `name` in lower case.
std::string header(const Request& request, const std::string& name);

/// The query parameter; nullopt when absent, the first when sent twice.
std::optional<std::string> parameter(const Request& request, const std::string& name);
/// A whole number in [min, max]. errors: invalid_argument.
Result<std::int64_t> whole_parameter(const Request& request, const std::string& name, std::int64_t otherwise,
                                     std::int64_t min, std::int64_t max);
/// true or false (also 1, 0). errors: invalid_argument.
Result<bool> flag_parameter(const Request& request, const std::string& name, bool otherwise);
/// Two texts parted by a comma: range=0.5,inf. errors: invalid_argument.
Result<std::pair<std::string, std::string>> pair_of(std::string_view name, const std::string& text);
/// errors: invalid_argument when a parameter is none of these.
Result<void> only_parameters(const Request& request, std::initializer_list<std::string_view> known);

/// What a Prefer header asks for (RFC 7240), as far as we honour it.
struct Preference {
  bool respond_async = false;
  std::optional<int> wait_seconds;  ///< at most 60
};
Preference preference(const Request& request);

/// Whether the client asks for this media type by name.
bool accepts(const Request& request, std::string_view media_type);

}  // namespace geosis::server::http
