#include "server/documents/node_grid_document.h"

#include "server/documents/ids.h"
#include "server/documents/object_reader.h"

namespace geosis::server {
namespace {

Json point_document(Vec3d point) {
  return {point.x, point.y, point.z};
}

Error not_taken(std::string_view name, std::string_view text, const char* expected) {
  return {ErrorCode::invalid_argument,
          std::string(name) + ": \"" + std::string(text) + "\"; expected " + std::string(expected)};
}

}  // namespace

Json node_grid_document(const NodeSummary& grid, const std::string& volume, const std::string& kind) {
  return {{"id", grid.digest},
          {"volume", volume},
          {"kind", kind},
          {"dims", {grid.shape.inlines, grid.shape.crosslines, grid.shape.samples}},
          {"bytes", grid.bytes},
          {"mirrored", grid.report.mirrored},
          {"folded_share", grid.report.folded_share},
          {"times", grid.times},
          {"box", {point_document(grid.low), point_document(grid.high)}}};
}

const char* name_of(PositionFormat::Kind kind) {
  return kind == PositionFormat::Kind::nodes ? "nodes" : "pillars";
}

Result<void> set_position_option(PositionFormat& format, std::string_view name, std::string_view text) {
  if (name == "kind") {
    if (text != "nodes" && text != "pillars") return not_taken(name, text, "nodes or pillars");
    format.kind = text == "nodes" ? PositionFormat::Kind::nodes : PositionFormat::Kind::pillars;
  } else if (name == "dtype") {
    if (text != "float32" && text != "float64") return not_taken(name, text, "float32 or float64");
    format.is_double = text == "float64";
  } else if (name == "byte_order") {
    if (text != "little" && text != "big") return not_taken(name, text, "little or big");
    format.big_endian = text == "big";
  } else {
    return Error{ErrorCode::invalid_argument, std::string(name) + ": there is no such option of a grid"};
  }
  return {};
}

Result<CoordinateIds> parse_coordinates(const Json& document) {
  std::optional<Error> problem;
  ObjectReader reader(document, "", problem);
  CoordinateIds ids;
  bool any = false;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Json* member = reader.find(kCoordinateNames[axis]);
    if (member == nullptr || member->is_null()) continue;
    any = true;
    if (member->is_string() && is_id(member->get<std::string>()))
      ids.of[axis] = member->get<std::string>();
    else
      reader.refuse(reader.pointer_to(kCoordinateNames[axis]), *member, "the id of a volume");
  }
  reader.refuse_unknown();
  if (problem) return *std::move(problem);
  if (!any) return Error{ErrorCode::invalid_argument, "request /z: none of x, y and z is given; expected one at least"};
  return ids;
}

VolumeSummary placed_on(const VolumeSummary& volume, const NodeSummary& grid) {
  VolumeSummary placed = volume;
  if (!grid.times) placed.sample_unit.clear();
  return placed;
}

}  // namespace geosis::server
