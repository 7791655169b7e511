#include "server/documents/request_check.h"

#include <string>

namespace geosis::server {
namespace {

constexpr const char* kAxisNames[] = {"inline", "crossline", "sample"};

Error refusal(const std::string& pointer, const std::string& what) {
  return {ErrorCode::invalid_argument, "request " + pointer + ": " + what};
}

std::string dims_text(GridShape shape) {
  return std::to_string(shape.inlines) + " x " + std::to_string(shape.crosslines) + " x " +
         std::to_string(shape.samples);
}

Result<void> check_region(const std::optional<GridBox>& region, GridShape shape) {
  for (int axis = 0; region && axis < 3; ++axis) {
    if (region->last[axis] < shape[axis]) continue;
    return refusal("/region/" + std::string(kAxisNames[axis]),
                   "[" + std::to_string(region->first[axis]) + "," + std::to_string(region->last[axis]) +
                       "]; the volume has nodes 0 to " + std::to_string(shape[axis] - 1));
  }
  return {};
}

Result<void> check_seeds(const std::vector<GridIndex>& seeds, GridShape shape) {
  for (const GridIndex& seed : seeds) {
    for (int axis = 0; axis < 3; ++axis) {
      if (seed[axis] < shape[axis]) continue;
      return refusal("/bodies/seeds", "[" + std::to_string(seed.i) + "," + std::to_string(seed.j) + "," +
                                          std::to_string(seed.k) + "]; the volume has " + dims_text(shape) + " nodes");
    }
  }
  return {};
}

}  // namespace

Result<void> check_request(const ReconstructOptions& options, const VolumeSummary& volume) {
  if (auto inside = check_region(options.region, volume.shape); !inside) return inside;
  if (auto inside = check_seeds(options.bodies.seeds, volume.shape); !inside) return inside;
  if (options.velocity && volume.sample_unit != "ms") {
    return refusal("/velocity", "given, but the samples of this volume are not times (their unit is \"" +
                                    volume.sample_unit + "\")");
  }
  return {};
}

Result<void> check_placed_grid(const ReconstructOptions& options, const Json& grid) {
  if (!options.velocity || options.index_space || grid.value("times", false)) return {};
  return refusal("/velocity", "given, but the grid has depths already");
}

Result<void> check_same_nodes(const std::string& pointer, GridShape other, GridShape volume) {
  if (other == volume) return {};
  return refusal(pointer, "a volume of " + dims_text(other) + " nodes; the volume itself has " + dims_text(volume));
}

Result<void> check_attribute_volume(const VolumeSummary& attribute_volume, const VolumeSummary& volume) {
  return check_same_nodes("/attribute_volume", attribute_volume.shape, volume.shape);
}

}  // namespace geosis::server
