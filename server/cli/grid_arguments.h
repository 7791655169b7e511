#pragma once

#include <array>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/volume/formats/import.h"
#include "engine/volume/node_file.h"

namespace geosis::server {

/// The flags that say where the nodes of the volume's grid lie: --grid-nodes, --grid-pillars, --grid-x, ...
class GridArguments {
 public:
  explicit GridArguments(CLI::App& command);

  /// The grid, in an unnamed temporary file; nullopt when none is given.
  ///
  /// errors   invalid_argument: more than one way at a time, a coordinate of another shape.  Those of import_positions,
  ///          place_nodes and of reading the files.
  Result<std::optional<NodeGrid>> open(const VolumeDescription& volume, int threads, Progress& progress) const;

  /// "nodes", "pillars" or "volumes".
  std::string kind() const;

 private:
  Result<NodeGrid> open_positions(GridShape shape, int threads, Progress& progress) const;
  Result<NodeGrid> open_coordinates(const VolumeDescription& volume, int threads, Progress& progress) const;
  bool has_coordinates() const;

  std::string nodes_, pillars_, dtype_, byte_order_;
  std::array<std::string, 3> coordinates_;  ///< files of x, y, z
};

}  // namespace geosis::server
