#pragma once

#include <initializer_list>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "server/app/volumes/volumes.h"
#include "server/http/routing/exchange.h"

namespace geosis::server::http {

/// Import options from query parameters; `others` are parameters that mean something else.
///
/// errors   invalid_argument: an unknown parameter, or a value that its option does not take.
Result<UploadOptions> upload_options(const std::multimap<std::string, std::string>& query,
                                     std::initializer_list<std::string_view> others);

/// Import options from a form: its field `options` holds them as JSON, {"dims": [64, 64, 93], ...}. They win over the
/// query.
Result<void> add_form_options(const std::map<std::string, std::string>& fields, UploadOptions& options);

/// The refusal of a file, with the grids that it could be.
Reply upload_refusal(const Error& error, const std::vector<GridCandidate>& candidates);

}  // namespace geosis::server::http
