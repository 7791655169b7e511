#include "server/app/derived/grid_calls.h"

#include <array>
#include <span>
#include <utility>

#include "server/app/volumes/arriving_file.h"
#include "server/documents/node_grid_document.h"
#include "server/documents/request_check.h"

namespace geosis::server {
namespace {

using OpenCoordinates = std::array<std::shared_ptr<const StoredVolume>, 3>;

/// An error of one coordinate, with the pointer to it.
Error about(std::size_t axis, const Error& error) {
  return {error.code, std::string("request /") + kCoordinateNames[axis] + ": " + error.message};
}

/// What place_nodes says of a coordinate ("z: node ...") as an error of the request's field. A damaged brick is the
/// server's fault.
Error located(const Services& services, const CoordinateIds& ids, const Error& error) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::string name = std::string(kCoordinateNames[axis]) + ": ";
    if (!error.message.starts_with(name)) continue;
    const Error bare = {error.code, error.message.substr(name.size())};
    const bool is_damage = ids.of[axis] && bare.message.starts_with("brick file");
    return about(axis, is_damage ? services.volumes.judged(*ids.of[axis], bare) : bare);
  }
  return error;
}

Result<OpenCoordinates> open_coordinates(const Services& services, GridShape shape, const CoordinateIds& ids) {
  OpenCoordinates opened;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!ids.of[axis]) continue;
    auto volume = services.volumes.open(*ids.of[axis]);
    if (!volume) return about(axis, volume.error());
    const std::string pointer = std::string("/") + kCoordinateNames[axis];
    if (auto fits = check_same_nodes(pointer, (*volume)->summary.shape, shape); !fits) return std::move(fits).error();
    opened[axis] = *std::move(volume);
  }
  return opened;
}

}  // namespace

Result<AddedGrid> upload_grid(const Services& services, const std::string& volume, CheckedBody& body,
                              std::optional<std::uint64_t> announced, const PositionFormat& format,
                              Progress& progress) {
  const auto stored = services.volumes.open(volume);
  if (!stored) return stored.error();
  const std::uint64_t expected = position_bytes((*stored)->summary.shape, format);
  const ArrivingFile file(announced.value_or(expected), [&](std::span<std::byte> into) { return body.read(into); });
  const auto confirm = [&]() -> Result<void> {
    const auto more = goes_on(body);
    if (!more) return more.error();
    if (*more) return bad_positions("more than the " + std::to_string(expected) + " bytes of the volume's nodes");
    return body.check();
  };
  return services.volumes.grids().add((*stored)->summary, file, format, confirm, progress);
}

Result<AddedGrid> create_grid(const Services& services, const std::string& volume, const Json& coordinates,
                              Progress& progress) {
  const auto stored = services.volumes.open(volume);
  if (!stored) return stored.error();
  const auto ids = parse_coordinates(coordinates);
  if (!ids) return ids.error();
  const VolumeSummary& summary = (*stored)->summary;
  const auto opened = open_coordinates(services, summary.shape, *ids);
  if (!opened) return opened.error();
  std::array<const BrickedVolume*, 3> samples{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if ((*opened)[axis]) samples[axis] = (*opened)[axis]->samples.get();
  }
  auto added = services.volumes.grids().place(summary, samples, progress);
  if (!added) return located(services, *ids, added.error());
  return added;
}

Result<std::shared_ptr<Job>> begin_grid(const Services& services, const std::string& volume, const Json& coordinates,
                                        std::shared_ptr<AddedGrid> added) {
  const auto create = [services, volume, coordinates, added = std::move(added)](Job& job) -> Result<void> {
    auto result = create_grid(services, volume, coordinates, job);
    if (!result) return std::move(result).error();
    *added = *std::move(result);
    return {};
  };
  return services.queue.submit(
      JobDemand{
          .memory_bytes = kImportMemoryBytes, .tenant = services.volumes.tenant(), .what = "grid of volume " + volume},
      create);
}

Result<Json> list_grids(const Services& services, const std::string& volume, std::size_t page_size,
                        const std::string& page_token) {
  if (const auto known = services.volumes.document(volume); !known) return known.error();
  return services.volumes.grids().list(volume, page_size, page_token);
}

Result<Json> show_grid(const Services& services, const std::string& volume, const std::string& grid) {
  if (const auto known = services.volumes.document(volume); !known) return known.error();
  return services.volumes.grids().document(volume, grid);
}

Result<void> remove_grid(const Services& services, const std::string& volume, const std::string& grid) {
  const auto known = services.volumes.grids().document(volume, grid);
  if (!known && known.error().code != ErrorCode::internal) return known.error();
  // Before, so that who is cut short can try again; and after, for what was asked for meanwhile.
  if (auto purged = services.extractions.purge_results_on(volume, grid); !purged) return purged;
  if (auto removed = services.volumes.grids().remove(volume, grid); !removed) return removed;
  return services.extractions.purge_results_on(volume, grid);
}

}  // namespace geosis::server
