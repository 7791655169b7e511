#include "engine/isosurface/brick_sweep.h"

#include <cmath>
#include <cstdint>
#include <string>

#include "engine/isosurface/cell_presence.h"
#include "engine/volume/brick_layout.h"

namespace geosis {
namespace {

constexpr const char* kAxisNames[] = {"inline", "crossline", "sample"};

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

enum class Content { nothing, body, surface };

/// What a brick may hold of the body in the region, by the index alone.
Content content_of(const BrickedVolume& volume, const BrickLayout& layout, std::size_t brick, IsoRange range,
                   const ExtractOptions& options) {
  const BrickSummary summary = volume.summary(brick);
  if (summary.all_missing) return Content::nothing;
  const GridIndex place = layout.place(brick), first = layout.first_node(place);
  const GridShape extent = layout.extent(place);
  bool at_border = false;
  for (int axis = 0; axis < 3; ++axis) {
    const int last = first[axis] + extent[axis] - 1;
    if (options.region.first[axis] >= last || options.region.last[axis] <= first[axis]) {
      return Content::nothing;  // no cell
    }
    at_border = at_border || options.region.first[axis] >= first[axis] || options.region.last[axis] <= last;
  }
  const auto [min, max] = summary.range;
  if ((min < range.low && max >= range.low) || (min <= range.high && max > range.high)) return Content::surface;
  const bool has_inside = max >= range.low && min <= range.high;
  if (!has_inside) return Content::nothing;
  return options.cap && (at_border || misses_nearby(volume, place)) ? Content::surface : Content::body;
}

std::vector<std::size_t> bricks_with(Content content, const BrickedVolume& volume, IsoRange range,
                                     const ExtractOptions& options) {
  const BrickLayout layout(volume.shape());
  std::vector<std::pair<std::uint64_t, std::size_t>> found;
  for (std::size_t brick = 0; brick < layout.brick_count(); ++brick) {
    if (content_of(volume, layout, brick, range, options) == content) {
      found.emplace_back(morton_code(layout.place(brick)), brick);
    }
  }
  std::sort(found.begin(), found.end());
  std::vector<std::size_t> bricks;
  bricks.reserve(found.size());
  for (const auto& [code, brick] : found) bricks.push_back(brick);
  return bricks;
}

}  // namespace

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

std::vector<std::size_t> active_bricks(const BrickedVolume& volume, IsoRange range, const ExtractOptions& options) {
  return bricks_with(Content::surface, volume, range, options);
}

std::vector<std::size_t> quiet_bricks(const BrickedVolume& volume, IsoRange range, const ExtractOptions& options) {
  return bricks_with(Content::body, volume, range, options);
}

}  // namespace geosis
