#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "engine/base/result.h"
#include "engine/volume/formats/import.h"
#include "server/documents/json_text.h"

namespace geosis::server {

/// The volume document of the outside contract, as far as a file alone decides it: without the state, times and links
/// of a stored volume.
///
/// name   what people call the volume, for example its file's name.
Json volume_document(const VolumeDescription& volume, const std::string& name);

/// The geometry that a document's `transform` stands for: 16 numbers, row-major.
AffineGeometry geometry_of(const std::array<double, 16>& transform);

/// What a result needs to know of its volume.
struct VolumeSummary {
  std::string id;
  GridShape shape;
  AffineGeometry geometry;
  std::string sample_unit;
};

VolumeSummary summarize(const VolumeDescription& volume);

/// The summary from a volume document that volume_document made.
///
/// errors   malformed_input: a field that is absent or makes no sense.
Result<VolumeSummary> parse_volume_document(const Json& document);

/// The node that the survey calls `number` on an axis (0 = inline, 1 = crossline, 2 = sample); nullopt when there is
/// none.
std::optional<std::int32_t> node_called(const Json& document, int axis, double number);

/// The grids that a refused survey could be, as its refusal lists them.
Json candidates_document(const std::vector<GridCandidate>& candidates);

}  // namespace geosis::server
