#pragma once

#include <span>
#include <string_view>

#include "engine/base/result.h"
#include "engine/volume/formats/import.h"
#include "server/documents/json_text.h"

namespace geosis::server {

/// An import option of the outside contract: a query parameter, and with dashes a flag of the command line.
struct ImportOptionName {
  const char* name;   ///< "inline_byte"
  const char* value;  ///< what its text looks like: "BYTE", "little|big"
  const char* help;
};

std::span<const ImportOptionName> import_option_names();

/// Sets one option from its text.
///
/// errors   invalid_argument: no such option, or text that it does not take.
Result<void> set_import_option(ImportOptions& options, std::string_view name, std::string_view text);

/// Sets those that a JSON object names, {"dims": [64, 64, 93], ...}; null leaves its option as it is. errors: as above.
Result<void> set_import_options(ImportOptions& options, const Json& document);

/// The canonical form: every option that the format has, unset ones as null.
Json import_options_document(const ImportOptions& options);

}  // namespace geosis::server
