#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>

#include "engine/base/progress.h"
#include "engine/base/result.h"
#include "engine/volume/bricks.h"
#include "engine/volume/formats/byte_source.h"
#include "engine/volume/geometry.h"
#include "engine/volume/grid.h"
#include "engine/volume/node_file.h"

namespace geosis {

/// How a file of node positions is laid out. Numbers alone, all of one type.
struct PositionFormat {
  enum class Kind {
    nodes,   ///< x, y, z of each node, sample fastest
    pillars  ///< x, y, z of the top and the bottom of each trace's pillar, crossline fastest; then a depth of each node
  };
  Kind kind = Kind::nodes;
  bool is_double = false;  ///< float64 instead of float32
  bool big_endian = false;
};

/// Size of such a file. shape: has passed check_axes.
std::uint64_t position_bytes(GridShape shape, const PositionFormat& format);

/// Reads a file of positions once, in order, so that it may still arrive, into a node file.
///
/// node_file   where the node file appears; nullopt = an unnamed temporary one.
/// errors      malformed_input: another size, and as NodeFileWriter; a pillar as check_pillar says.  cancelled.
///             Those of the source.
/// memory      2 MB; pillars are kept in an unnamed file beside the node file.
Result<NodeGrid> import_positions(const ByteSource& source, GridShape shape, const PositionFormat& format,
                                  const std::optional<std::filesystem::path>& node_file, int threads,
                                  Progress& progress);

/// Nodes whose coordinates are samples of other volumes, and where no volume is given those of a geometry.
struct CoordinateVolumes {
  std::array<const BrickedVolume*, 3> volumes{};  ///< of x, y, z; each of the grid's shape, or null
  const GridGeometry& otherwise;
  bool times = false;  ///< what the geometry says of z is two-way time
};

/// errors   malformed_input: a sample is missing ("z: node [1,2,3] is missing"); as NodeFileWriter.  cancelled.
/// memory   some MB.
Result<NodeGrid> place_nodes(const CoordinateVolumes& coordinates, GridShape shape,
                             const std::optional<std::filesystem::path>& node_file, int threads, Progress& progress);

}  // namespace geosis
