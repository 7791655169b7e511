#pragma once

#include <array>
#include <cstdint>

#include "engine/isosurface/cell.h"

namespace geosis {

/// How the body lies in one border face of a present cell, in the face's frame (corner m, edge m = corner m to m + 1).
struct CapFace {
  int face = 0;  ///< of the present cell
  int sheets = 0;
  std::array<std::uint8_t, 2> above{};  ///< per sheet: bit m = corner m above it
  std::array<bool, 2> body_is_above{};  ///< per sheet: which side of it the body lies on
  std::uint8_t inside = 0;              ///< bit m = corner m in the body
  std::array<bool, 2> joined{};         ///< per sheet, where its signs alternate: the corners above are joined
  std::uint8_t contact_edges = 0;  ///< bit m = edge m is a contact (it gets a vertex in its middle if wholly inside)
};

/// A vertex of the cap: on a node, on an edge where a sheet crosses it, or in the middle of a contact edge.
struct CapVertex {
  enum class Kind : std::uint8_t { node, crossing, middle };
  Kind kind = Kind::node;
  std::uint8_t sheet = 0;  ///< of a crossing
  std::uint8_t place = 0;  ///< corner or edge m
};

struct CapTriangles {
  int count = 0;
  std::array<std::array<CapVertex, 3>, 16> triangle{};
};

/// The part of the face that is in the body, as triangles that look out of the present cell.
///
/// They cut the face by the same decisions as the cells do and use only those chords between crossings that the absent
/// neighbour could have used, so that no edge is drawn twice.
CapTriangles cap_face(const CapFace& face);

}  // namespace geosis
