#pragma once

#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include "engine/base/result.h"

namespace geosis::server {

/// Members keep the order in which they were written, as readers of our documents expect.
using Json = nlohmann::ordered_json;

/// The JSON value of the text, strictly: no comments, no member twice, at most 32 levels deep.
///
/// errors   malformed_input, with line and column.
Result<Json> parse_json(std::string_view text);

/// The one text of a value that ids are made of: no spaces, members sorted by their UTF-8 bytes, each number in the
/// shortest form that reads back as the same double, whole numbers without a fraction (1, never 1.0).
std::string canonical_text(const Json& value);

/// The text of a document for people: indented, ends with a new line; bytes that are not UTF-8 become U+FFFD.
std::string document_text(const Json& value);

/// JSON has no NaN and no infinity: those become null.
Json number_or_null(double number);

}  // namespace geosis::server
