#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/base/result.h"
#include "engine/volume/curvilinear_geometry.h"
#include "engine/volume/node_offsets.h"

namespace geosis {

/// What a node file says of its grid.
struct NodeSummary {
  GridShape shape;
  bool times = false;  ///< z is the survey's two-way time: the axes have no unit in common
  std::string digest;  ///< SHA-256 of all that decides where the nodes are, hexadecimal: the grid's name
  NodeReport report;
  Vec3d low, high;          ///< the box of the nodes in the world
  std::uint64_t bytes = 0;  ///< of the file
};

/// A grid on a file, which is mapped: its positions take no memory of their own.
struct NodeGrid {
  CurvilinearGeometry geometry;
  NodeSummary summary;
};

/// Writes a node file (docs/formats/node-file.md) from positions that come piece by piece: memory is one piece. They
/// are hashed on their way, and begin to go to the disk while others still come.
class NodeFileWriter {
 public:
  /// path     where it appears once it is whole; nullopt = an unnamed temporary file.
  /// errors   malformed_input: an axis with less than two nodes.  no_space, unavailable.
  static Result<NodeFileWriter> create(GridShape shape, bool times, const std::optional<std::filesystem::path>& path);

  NodeFileWriter(NodeFileWriter&&) noexcept;
  ~NodeFileWriter();

  /// The next nodes, sample fastest. errors: those of NodeOffsets::add; no_space, unavailable.
  Result<void> put(std::span<const Vec3d> nodes);
  /// Looks at the cells and gives the file its name.
  ///
  /// errors   malformed_input: nodes are missing, too many cells are folded.  no_space, unavailable.
  Result<NodeGrid> finish(int threads) &&;

 private:
  struct State;
  explicit NodeFileWriter(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// The grid in a file's bytes, which may be anything.
///
/// owner    keeps the bytes; they begin at an address that a float may have.
/// errors   malformed_input: not a node file, of another shape, cut short, damaged.  unsupported: another version.
/// cost     one read of the bytes.
Result<NodeGrid> read_node_file(GridShape shape, std::span<const std::byte> file, std::shared_ptr<const void> owner);

/// errors   as read_node_file; not_found, unavailable.
Result<NodeGrid> open_node_file(GridShape shape, const std::filesystem::path& path);

}  // namespace geosis
