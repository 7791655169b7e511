#include "engine/volume/brick_layout.h"

#include <algorithm>
#include <string>

namespace geosis {
namespace {

std::int32_t bricks_along(std::int32_t nodes) {
  return std::max<std::int32_t>(1, (nodes - 1 + kBrickCells - 1) / kBrickCells);
}

std::int32_t extent_along(std::int32_t nodes, std::int32_t brick) {
  return std::min(kBrickSamples, nodes - kBrickCells * brick);
}

std::uint64_t stored_along(std::int32_t nodes, std::int32_t bricks) {
  return static_cast<std::uint64_t>(nodes) + static_cast<std::uint64_t>(bricks) - 1;
}

}  // namespace

Result<void> check_axes(GridShape shape) {
  static constexpr const char* kNames[] = {"inlines", "crosslines", "samples"};
  for (int axis = 0; axis < 3; ++axis) {
    const std::string what = "volume of " + std::to_string(shape[axis]) + " " + kNames[axis];
    if (shape[axis] < 1) return Error{ErrorCode::invalid_argument, what + "; expected at least 1"};
    if (shape[axis] > kMaxAxisNodes)
      return Error{ErrorCode::limit_exceeded, what + "; the limit is " + std::to_string(kMaxAxisNodes)};
  }
  return {};
}

BrickSpan bricks_with(std::int32_t node, std::int32_t bricks) {
  const std::int32_t upper = std::min(node / kBrickCells, bricks - 1);
  const bool is_shared = node > 0 && node % kBrickCells == 0 && node / kBrickCells == upper;
  return {is_shared ? upper - 1 : upper, upper};
}

BrickLayout::BrickLayout(GridShape shape)
    : shape_(shape), grid_{bricks_along(shape.inlines), bricks_along(shape.crosslines), bricks_along(shape.samples)} {}

std::size_t BrickLayout::number(GridIndex place) const {
  return (static_cast<std::size_t>(place.i) * static_cast<std::size_t>(grid_.crosslines) +
          static_cast<std::size_t>(place.j)) *
             static_cast<std::size_t>(grid_.samples) +
         static_cast<std::size_t>(place.k);
}

GridIndex BrickLayout::place(std::size_t brick) const {
  const auto along_k = static_cast<std::size_t>(grid_.samples);
  const auto along_j = static_cast<std::size_t>(grid_.crosslines);
  return {static_cast<std::int32_t>(brick / along_k / along_j), static_cast<std::int32_t>(brick / along_k % along_j),
          static_cast<std::int32_t>(brick % along_k)};
}

GridIndex BrickLayout::first_node(GridIndex place) const {
  return {place.i * kBrickCells, place.j * kBrickCells, place.k * kBrickCells};
}

GridShape BrickLayout::extent(GridIndex place) const {
  return {extent_along(shape_.inlines, place.i), extent_along(shape_.crosslines, place.j),
          extent_along(shape_.samples, place.k)};
}

std::uint64_t BrickLayout::sample_offset(GridIndex place) const {
  constexpr std::uint64_t full = kBrickSamples;  // every brick before this one on its axis is whole
  const GridShape size = extent(place);
  const std::uint64_t stored_j = stored_along(shape_.crosslines, grid_.crosslines);
  const std::uint64_t stored_k = stored_along(shape_.samples, grid_.samples);
  const auto rows = static_cast<std::uint64_t>(size.inlines);
  const auto columns = static_cast<std::uint64_t>(size.crosslines);
  return full * static_cast<std::uint64_t>(place.i) * stored_j * stored_k +
         rows * (full * static_cast<std::uint64_t>(place.j) * stored_k +
                 columns * full * static_cast<std::uint64_t>(place.k));
}

std::uint64_t BrickLayout::stored_samples() const {
  return stored_along(shape_.inlines, grid_.inlines) * stored_along(shape_.crosslines, grid_.crosslines) *
         stored_along(shape_.samples, grid_.samples);
}

}  // namespace geosis
