#include "server/cli/grid_arguments.h"

#include <algorithm>
#include <utility>

#include "server/documents/node_grid_document.h"

namespace geosis::server {
namespace {

Error about_file(const std::string& path, const Error& error) {
  return {error.code, path + ": " + error.message};
}

}  // namespace

GridArguments::GridArguments(CLI::App& command) {
  constexpr const char* kGroup = "Node positions";
  command.add_option("--grid-nodes", nodes_, "where the grid's nodes lie: x, y, z of each, sample fastest")
      ->type_name("FILE")
      ->group(kGroup);
  command
      .add_option("--grid-pillars", pillars_,
                  "the same as x, y, z of the top and the bottom of each trace's pillar, then a depth of each node")
      ->type_name("FILE")
      ->group(kGroup);
  command.add_option("--grid-dtype", dtype_, "of those files: float32 (default) or float64")
      ->type_name("TYPE")
      ->group(kGroup);
  command.add_option("--grid-byte-order", byte_order_, "of those files: little (default) or big")
      ->type_name("ORDER")
      ->group(kGroup);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::string name = kCoordinateNames[axis];
    command
        .add_option("--grid-" + name, coordinates_[axis],
                    "SEG-Y file whose samples are the nodes' " + name + "; without it the survey's own")
        ->type_name("FILE")
        ->group(kGroup);
  }
}

bool GridArguments::has_coordinates() const {
  return std::ranges::any_of(coordinates_, [](const std::string& path) { return !path.empty(); });
}

std::string GridArguments::kind() const {
  return !nodes_.empty() ? "nodes" : !pillars_.empty() ? "pillars" : "volumes";
}

Result<std::optional<NodeGrid>> GridArguments::open(const VolumeDescription& volume, int threads,
                                                    Progress& progress) const {
  const int ways = int{!nodes_.empty()} + int{!pillars_.empty()} + int{has_coordinates()};
  if (ways > 1) {
    return Error{ErrorCode::invalid_argument, "give nodes, pillars or coordinates of the grid, one of these"};
  }
  if (ways == 0) {
    if (dtype_.empty() && byte_order_.empty()) return std::optional<NodeGrid>();
    return Error{ErrorCode::invalid_argument, "--grid-dtype and --grid-byte-order need --grid-nodes or --grid-pillars"};
  }
  auto grid =
      has_coordinates() ? open_coordinates(volume, threads, progress) : open_positions(volume.shape, threads, progress);
  if (!grid) return std::move(grid).error();
  return std::optional(*std::move(grid));
}

Result<NodeGrid> GridArguments::open_positions(GridShape shape, int threads, Progress& progress) const {
  PositionFormat format;
  format.kind = nodes_.empty() ? PositionFormat::Kind::pillars : PositionFormat::Kind::nodes;
  for (const auto& [name, text] : {std::pair{"dtype", &dtype_}, {"byte_order", &byte_order_}}) {
    if (text->empty()) continue;
    if (auto set = set_position_option(format, name, *text); !set) return std::move(set).error();
  }
  const std::string& path = nodes_.empty() ? pillars_ : nodes_;
  const auto file = open_file(path);
  if (!file) return file.error();
  auto grid = import_positions(**file, shape, format, std::nullopt, threads, progress);
  if (!grid) return about_file(path, grid.error());
  return grid;
}

Result<NodeGrid> GridArguments::open_coordinates(const VolumeDescription& volume, int threads,
                                                 Progress& progress) const {
  std::array<std::optional<ImportedVolume>, 3> imported;
  CoordinateVolumes given{.otherwise = volume.geometry, .times = volume.sample_unit == "ms"};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::string& path = coordinates_[axis];
    if (path.empty()) continue;
    const auto file = open_file(path);
    if (!file) return file.error();
    auto other = import_volume(**file, {}, std::nullopt, progress);
    if (!other) return about_file(path, other.error());
    if (other->description.shape != volume.shape) {
      return about_file(path, {ErrorCode::invalid_argument, "it has other dimensions than the volume"});
    }
    imported[axis] = *std::move(other);
    given.volumes[axis] = imported[axis]->samples.get();
  }
  return place_nodes(given, volume.shape, std::nullopt, threads, progress);
}

}  // namespace geosis::server
