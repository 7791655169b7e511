#pragma once

#include <cstddef>
#include <filesystem>
#include <span>

#include "engine/base/result.h"
#include "engine/structure/structural_grid.h"
#include "engine/volume/grid.h"

namespace geosis {

/// Keeps a structural grid in a file (docs/formats/grid-file.md), which appears when it is complete.
///
/// errors   no_space, unavailable.
Result<void> write_grid_file(const StructuralGrid& grid, const std::filesystem::path& path);

/// The grid in a file's bytes, which may be anything.
///
/// shape    of the volume that it must be of.
/// errors   malformed_input: not a grid file, of another volume, cut short, damaged.  unsupported: another version.
/// cost     one read of the bytes; memory: the result.
Result<StructuralGrid> read_grid_file(GridShape shape, std::span<const std::byte> file);

/// errors   as read_grid_file; not_found, unavailable.
Result<StructuralGrid> open_grid_file(GridShape shape, const std::filesystem::path& path);

}  // namespace geosis
