#include "engine/volume/slice.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>

#include "engine/volume/brick_layout.h"

namespace geosis {
namespace {

/// How a plane lies in the volume and in the slice: its two axes in grid order, and how far apart neighbours along
/// each of them are in the slice's samples.
struct Plane {
  int normal, outer, inner;
  std::int32_t rows, columns;
  std::size_t outer_stride, inner_stride;
};

Plane plane_across(SliceAxis axis, GridShape shape) {
  const auto crosslines = static_cast<std::size_t>(shape.crosslines);
  const auto inlines = static_cast<std::size_t>(shape.inlines);
  switch (axis) {
    case SliceAxis::inline_:
      return {0, 1, 2, shape.samples, shape.crosslines, 1, crosslines};
    case SliceAxis::crossline:
      return {1, 0, 2, shape.samples, shape.inlines, 1, inlines};
    case SliceAxis::sample:
      break;
  }
  return {2, 0, 1, shape.inlines, shape.crosslines, crosslines, 1};
}

Result<void> check_slice(const Plane& plane, GridShape shape, std::int32_t index) {
  static constexpr const char* kNames[] = {"inline", "crossline", "sample"};
  const std::string name = kNames[plane.normal];
  if (index < 0 || index >= shape[plane.normal])
    return Error{ErrorCode::invalid_argument, name + " slice " + std::to_string(index) +
                                                  "; expected a node number, 0.." +
                                                  std::to_string(shape[plane.normal] - 1)};
  const std::int64_t count = std::int64_t{plane.rows} * plane.columns;
  if (count > kMaxSliceSamples)
    return Error{ErrorCode::limit_exceeded, name + " slice of " + std::to_string(plane.rows) + " x " +
                                                std::to_string(plane.columns) + " samples; the limit is " +
                                                std::to_string(kMaxSliceSamples)};
  return {};
}

// Reads along the storage order of the brick; the two strides turn the section upright.
void copy_plane(const BrickView& brick, const Plane& plane, std::int32_t index, Slice& slice) {
  const auto row = static_cast<std::size_t>(brick.extent.samples);
  const std::array<std::size_t, 3> stride = {static_cast<std::size_t>(brick.extent.crosslines) * row, row, 1};
  const auto layer = static_cast<std::size_t>(index - brick.first[plane.normal]);
  const auto outer_count = static_cast<std::size_t>(brick.extent[plane.outer]);
  const auto inner_count = static_cast<std::size_t>(brick.extent[plane.inner]);
  const float* from = brick.samples + layer * stride[static_cast<std::size_t>(plane.normal)];
  float* to = slice.samples.data() + static_cast<std::size_t>(brick.first[plane.outer]) * plane.outer_stride +
              static_cast<std::size_t>(brick.first[plane.inner]) * plane.inner_stride;
  for (std::size_t u = 0; u < outer_count; ++u) {
    const float* source = from + u * stride[static_cast<std::size_t>(plane.outer)];
    float* target = to + u * plane.outer_stride;
    for (std::size_t v = 0; v < inner_count; ++v)
      target[v * plane.inner_stride] = source[v * stride[static_cast<std::size_t>(plane.inner)]];
  }
}

}  // namespace

Result<Slice> read_slice(const BrickedVolume& volume, SliceAxis axis, std::int32_t index) {
  const BrickLayout layout(volume.shape());
  const Plane plane = plane_across(axis, layout.shape());
  if (auto checked = check_slice(plane, layout.shape(), index); !checked) return std::move(checked).error();

  Slice slice{plane.rows, plane.columns, {}};
  slice.samples.resize(static_cast<std::size_t>(plane.rows) * static_cast<std::size_t>(plane.columns));
  GridIndex place;
  // A shared layer lies in two bricks; either has the same samples.
  place[plane.normal] = std::min(index / kBrickCells, layout.grid()[plane.normal] - 1);
  for (place[plane.outer] = 0; place[plane.outer] < layout.grid()[plane.outer]; ++place[plane.outer])
    for (place[plane.inner] = 0; place[plane.inner] < layout.grid()[plane.inner]; ++place[plane.inner]) {
      const auto brick = volume.brick(layout.number(place));
      if (!brick) return brick.error();
      copy_plane(*brick, plane, index, slice);
    }
  return slice;
}

}  // namespace geosis
