#pragma once

#include <string>

#include "engine/base/result.h"
#include "engine/pipeline/reconstruct.h"
#include "server/documents/volume_document.h"

namespace geosis::server {

/// Whether a request makes sense for this volume: what cannot be computed is refused before anything is recorded.
///
/// errors   invalid_argument, starting with the field's pointer: a region or seed outside the volume, a velocity for a
///          survey that is not in time.
Result<void> check_request(const ReconstructOptions& options, const VolumeSummary& volume);

/// The same for the grid that the request names, by its document.
///
/// errors   invalid_argument: a velocity where the grid has depths already.
Result<void> check_placed_grid(const ReconstructOptions& options, const Json& grid);

/// The same for another volume that the request names: it must have as many nodes along each axis.
///
/// pointer   to where it is named, "/z".
/// errors    invalid_argument.
Result<void> check_same_nodes(const std::string& pointer, GridShape other, GridShape volume);

/// The same for the volume that the attribute "value" is of.
Result<void> check_attribute_volume(const VolumeSummary& attribute_volume, const VolumeSummary& volume);

}  // namespace geosis::server
