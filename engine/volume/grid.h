#pragma once

#include <cstdint>

namespace geosis {

/// Number of grid nodes along each axis. Order everywhere: (inline, crossline, sample) = (i, j, k), k fastest.
struct GridShape {
  std::int32_t inlines = 0, crosslines = 0, samples = 0;

  constexpr std::int32_t operator[](int axis) const { return axis == 0 ? inlines : axis == 1 ? crosslines : samples; }
  constexpr std::int64_t count() const { return std::int64_t{inlines} * crosslines * samples; }
  constexpr bool operator==(const GridShape&) const = default;
};

/// A node of the grid, or a brick's place in the grid of bricks.
struct GridIndex {
  std::int32_t i = 0, j = 0, k = 0;

  constexpr std::int32_t operator[](int axis) const { return axis == 0 ? i : axis == 1 ? j : k; }
  constexpr std::int32_t& operator[](int axis) { return axis == 0 ? i : axis == 1 ? j : k; }
  constexpr bool operator==(const GridIndex&) const = default;
};

/// A box of nodes; both ends belong to it.
struct GridBox {
  GridIndex first, last;

  constexpr bool operator==(const GridBox&) const = default;
};

constexpr GridBox whole(GridShape shape) {
  return {{0, 0, 0}, {shape.inlines - 1, shape.crosslines - 1, shape.samples - 1}};
}

}  // namespace geosis
