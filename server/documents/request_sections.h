#pragma once

#include <optional>

#include "engine/base/result.h"
#include "engine/pipeline/reconstruct.h"
#include "server/documents/json_text.h"
#include "server/documents/object_reader.h"

namespace geosis::server {

// The members of a request that are objects or lists of their own. Each is read strictly (object_reader.h) and written
// in its one canonical form: what has no effect on the result is written as its default.

FillOptions read_missing(ObjectReader& request, std::optional<Error>& problem);
Json missing_document(const FillOptions& fill);

BodyChoice read_bodies(ObjectReader& request, std::optional<Error>& problem);
Json bodies_document(const BodyChoice& bodies);

/// `attributes`, and `attribute_volume`, which `value` needs.
void read_attributes(ObjectReader& request, ReconstructOptions& options);
Json attributes_document(const AttributeChoice& attributes);

}  // namespace geosis::server
