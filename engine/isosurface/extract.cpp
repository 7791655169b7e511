#include "engine/isosurface/extract.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/parallel.h"
#include "engine/isosurface/brick_mesher.h"
#include "engine/isosurface/cell_presence.h"
#include "engine/isosurface/weld.h"
#include "engine/volume/brick_layout.h"

namespace geosis {
namespace {

constexpr const char* kStage = "extract";
constexpr const char* kAxisNames[] = {"inline", "crossline", "sample"};

Result<void> check_request(GridShape shape, IsoRange range, const ExtractOptions& options) {
  if (std::isnan(range.low) || std::isnan(range.high))
    return Error{ErrorCode::invalid_argument, "range: an end is NaN"};
  if (range.low > range.high) {
    return Error{ErrorCode::invalid_argument,
                 "range: low " + std::to_string(range.low) + " is above high " + std::to_string(range.high)};
  }
  for (int axis = 0; axis < 3; ++axis) {
    const int first = options.region.first[axis], last = options.region.last[axis];
    if (first >= 0 && first < last && last < shape[axis]) continue;
    return Error{ErrorCode::invalid_argument,
                 std::string("region: ") + kAxisNames[axis] + " [" + std::to_string(first) + ", " +
                     std::to_string(last) + "] is not two nodes or more inside 0.." + std::to_string(shape[axis] - 1)};
  }
  return {};
}

/// The bits of a brick's place, interleaved.
std::uint64_t morton_code(GridIndex place) {
  std::uint64_t code = 0;
  for (int bit = 0; bit < 21; ++bit) {
    for (int axis = 0; axis < 3; ++axis) {
      code |= static_cast<std::uint64_t>((place[axis] >> bit) & 1) << (3 * bit + 2 - axis);
    }
  }
  return code;
}

/// Whether a brick may hold some of the surface, by the index alone.
bool is_active(const BrickedVolume& volume, const BrickLayout& layout, std::size_t brick, IsoRange range,
               const ExtractOptions& options) {
  const BrickSummary summary = volume.summary(brick);
  if (summary.all_missing) return false;
  const GridIndex place = layout.place(brick), first = layout.first_node(place);
  const GridShape extent = layout.extent(place);
  bool at_border = false;
  for (int axis = 0; axis < 3; ++axis) {
    const int last = first[axis] + extent[axis] - 1;
    if (options.region.first[axis] >= last || options.region.last[axis] <= first[axis]) return false;  // no cell
    at_border = at_border || options.region.first[axis] >= first[axis] || options.region.last[axis] <= last;
  }
  const auto [min, max] = summary.range;
  if ((min < range.low && max >= range.low) || (min <= range.high && max > range.high)) return true;
  const bool has_inside = max >= range.low && min <= range.high;
  return options.cap && has_inside && (at_border || misses_nearby(volume, place));
}

/// Neighbours in the list are neighbours in space.
std::vector<std::size_t> active_bricks(const BrickedVolume& volume, const BrickLayout& layout, IsoRange range,
                                       const ExtractOptions& options) {
  std::vector<std::pair<std::uint64_t, std::size_t>> found;
  for (std::size_t brick = 0; brick < layout.brick_count(); ++brick) {
    if (is_active(volume, layout, brick, range, options)) found.emplace_back(morton_code(layout.place(brick)), brick);
  }
  std::sort(found.begin(), found.end());
  std::vector<std::size_t> bricks;
  for (const auto& [code, brick] : found) bricks.push_back(brick);
  return bricks;
}

/// Meshes all bricks, each worker with buffers of its own. The first error in the bricks' order wins.
Result<std::vector<BrickMesh>> mesh_bricks(const BrickedVolume& volume, IsoRange range, const ExtractOptions& options,
                                           const std::vector<std::size_t>& bricks, Progress& progress) {
  std::vector<BrickMesh> meshes(bricks.size());
  std::vector<std::optional<Error>> errors(bricks.size());
  std::atomic<std::size_t> next{0}, done{0};
  std::atomic<bool> failed{false};
  const std::size_t workers =
      std::min<std::size_t>(bricks.size(), static_cast<std::size_t>(std::max(options.threads, 1)));
  parallel_for(workers, options.threads, [&](std::size_t) {
    BrickMesher mesher(volume, range, options);
    for (std::size_t n; !failed && (n = next++) < bricks.size();) {
      if (progress.cancelled()) errors[n] = Error{ErrorCode::cancelled, "extraction was cancelled"};
      if (!errors[n]) {
        auto mesh = mesher.mesh(bricks[n]);
        mesh ? static_cast<void>(meshes[n] = std::move(mesh).value()) : static_cast<void>(errors[n] = mesh.error());
      }
      if (errors[n]) failed = true;
      progress.report(kStage, static_cast<double>(++done) / static_cast<double>(bricks.size()));
    }
  });
  for (auto& error : errors) {
    if (error) return *std::move(error);
  }
  return meshes;
}

}  // namespace

Result<IndexedMesh> extract_body(const BrickedVolume& volume, IsoRange range, const ExtractOptions& options,
                                 Progress& progress) {
  if (auto checked = check_request(volume.shape(), range, options); !checked) return std::move(checked).error();
  const BrickLayout layout(volume.shape());
  const auto bricks = active_bricks(volume, layout, range, options);
  auto meshes = mesh_bricks(volume, range, options, bricks, progress);
  if (!meshes) return std::move(meshes).error();
  return weld_bricks(layout, bricks, std::move(meshes).value(), options.max_triangles, options.threads);
}

}  // namespace geosis
