#pragma once

#include <string_view>

#include "engine/base/result.h"
#include "engine/pipeline/reconstruct.h"
#include "engine/volume/grid.h"
#include "server/documents/json_text.h"

namespace geosis::server {

/// What a request document asks for. `threads` is not part of a request and keeps its default.
///
/// Everything but `range` has a default; null ends of the range are open; the ends are rounded to float32.
/// errors   invalid_argument: unknown field, wrong type, value out of bounds.  unsupported: a value of the contract
///          that this version cannot compute. Messages start with the field's JSON pointer.
Result<ReconstructOptions> parse_request(const Json& document);

/// The canonical form of a request: every field of the contract, defaults filled in, the range as rounded, the region
/// as it applies to a volume of this shape. Two requests for the same result have the same canonical form.
Json request_document(const ReconstructOptions& options, GridShape shape);

/// A request's `range` from two numbers as people type them: "0.5", "-1e3", "inf", "-inf", "infinity".
///
/// errors   invalid_argument: not a number, NaN.
Result<Json> range_from_text(std::string_view low, std::string_view high);

}  // namespace geosis::server
