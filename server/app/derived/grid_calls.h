#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "engine/volume/formats/positions.h"
#include "server/app/derived/grids.h"
#include "server/app/services.h"
#include "server/app/volumes/body_reader.h"

namespace geosis::server {

// Calls about the grids of one volume.

/// Stores the grid that a body of positions makes; the body is written once, as it arrives.
///
/// announced   bytes of the body, where its sender said so.
/// errors      not_found: the volume.  Those of Grids::add and of the body.
Result<AddedGrid> upload_grid(const Services& services, const std::string& volume, CheckedBody& body,
                              std::optional<std::uint64_t> announced, const PositionFormat& format, Progress& progress);

/// Stores the grid whose coordinates are samples of stored volumes.
///
/// coordinates   {"x": id, "y": id, "z": id}; what is left out is the survey's own.
/// errors        not_found: the volume, or one that a coordinate names.  invalid_argument: the document, a volume of
///               another shape.  Those of Grids::place.
Result<AddedGrid> create_grid(const Services& services, const std::string& volume, const Json& coordinates,
                              Progress& progress);
/// The same as a job; `added` holds the result once it is done. errors: also those of the queue.
Result<std::shared_ptr<Job>> begin_grid(const Services& services, const std::string& volume, const Json& coordinates,
                                        std::shared_ptr<AddedGrid> added);

/// A page of the volume's grids. errors: not_found: the volume.
Result<Json> list_grids(const Services& services, const std::string& volume, std::size_t page_size,
                        const std::string& page_token);
/// errors: not_found: the volume, the grid.
Result<Json> show_grid(const Services& services, const std::string& volume, const std::string& grid);
/// Removes a grid and all results on it. errors: not_found.
Result<void> remove_grid(const Services& services, const std::string& volume, const std::string& grid);

}  // namespace geosis::server
