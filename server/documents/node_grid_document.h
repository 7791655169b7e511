#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "engine/base/result.h"
#include "engine/volume/formats/positions.h"
#include "engine/volume/node_file.h"
#include "server/documents/json_text.h"
#include "server/documents/volume_document.h"

namespace geosis::server {

/// The document of a grid of a volume, as far as its nodes decide it: without times and links.
///
/// kind   how its nodes were given: "nodes", "pillars" or "volumes".
Json node_grid_document(const NodeSummary& grid, const std::string& volume, const std::string& kind);

/// "nodes" or "pillars".
const char* name_of(PositionFormat::Kind kind);

/// Sets one of `kind`, `dtype` and `byte_order` of a file of positions.
///
/// errors   invalid_argument: another name, or a value that it does not take.
Result<void> set_position_option(PositionFormat& format, std::string_view name, std::string_view text);

/// Ids of the volumes that coordinates are taken from; nullopt = the survey's own.
struct CoordinateIds {
  std::array<std::optional<std::string>, 3> of;  ///< x, y, z
};

/// {"x": id, "y": id, "z": id}, at least one of them. errors: invalid_argument, with the pointer of what is wrong.
Result<CoordinateIds> parse_coordinates(const Json& document);
inline constexpr std::array<const char*, 3> kCoordinateNames = {"x", "y", "z"};

/// The volume as a grid places it: where nodes have depths, its vertical axis is no time any more.
VolumeSummary placed_on(const VolumeSummary& volume, const NodeSummary& grid);

}  // namespace geosis::server
