#include "server/http/routes/upload_options.h"

#include <algorithm>

#include "server/documents/import_options.h"
#include "server/http/routing/error_reply.h"

namespace geosis::server::http {
Result<UploadOptions> upload_options(const std::multimap<std::string, std::string>& query,
                                     std::initializer_list<std::string_view> others) {
  UploadOptions options;
  for (const auto& [name, value] : query) {
    if (std::find(others.begin(), others.end(), name) != others.end()) continue;
    if (auto set = set_import_option(options.import, name, value); !set) return std::move(set).error();
  }
  return options;
}

Result<void> add_form_options(const std::map<std::string, std::string>& fields, UploadOptions& options) {
  for (const auto& [name, text] : fields) {
    if (name == "name") {
      options.name = text;
      continue;
    }
    if (name != "options") return Error{ErrorCode::invalid_argument, "form field " + name + ": there is no such field"};
    const auto document = parse_json(text);
    if (!document || !document->is_object())
      return Error{ErrorCode::invalid_argument, "form field options: expected a JSON object"};
    if (auto set = set_import_options(options.import, *document); !set) return set;
  }
  return {};
}

Reply upload_refusal(const Error& error, const std::vector<GridCandidate>& candidates) {
  if (candidates.empty()) return error_reply(error);
  return error_reply(error, {{"candidates", candidates_document(candidates)}});
}

}  // namespace geosis::server::http
