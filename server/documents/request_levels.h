#pragma once

#include <optional>
#include <vector>

#include "engine/base/result.h"
#include "engine/pipeline/reconstruct.h"
#include "server/documents/json_text.h"
#include "server/documents/object_reader.h"

namespace geosis::server {

// `levels` and `simplify` of a request: read strictly, and written in their one canonical form.

/// Each level has one of `ratio`, `max_error` and `max_cost`. An `error_cap` that is left out has the default of the
/// ratio, null means none.
std::vector<LevelTarget> read_levels(ObjectReader& request, std::vector<LevelTarget> otherwise,
                                     std::optional<Error>& problem);
Json levels_document(const std::vector<LevelTarget>& levels);
/// The measure alone, as a manifest's level repeats it: {"ratio": 0.25}.
Json asked_document(const LevelTarget& level);

/// `simplify`: strategy, placement, seed.
void read_simplify(ObjectReader& request, ReconstructOptions& options, std::optional<Error>& problem);
Json simplify_document(const ReconstructOptions& options);

}  // namespace geosis::server
