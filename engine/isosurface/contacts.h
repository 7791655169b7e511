#pragma once

#include <array>
#include <bit>
#include <cstdint>

namespace geosis {

/// Where the domain touches itself only along an edge or at a point, the surface is split: one copy of the vertex per
/// sheet of the border that passes through. Cells around an edge or node are bits as CellPresence numbers them.
namespace contact {

/// Two cells face each other across the edge, and the two others are absent.
constexpr bool is_edge_contact(unsigned around_edge) {
  return around_edge == 0b1001 || around_edge == 0b0110;
}

/// Copy (0 or 1) of a contact edge's vertices that a cell around it uses; `place` is the cell's bit.
constexpr int edge_copy(int place) {
  return place >= 2 ? 1 : 0;
}

/// A cell (its bit) among those around an edge that uses copy 0 or 1 of a contact edge; for any other edge, and copy 0,
/// one of the cells around it.
constexpr int edge_place(unsigned around_edge, int copy) {
  return copy == 0 ? std::countr_zero(around_edge) : std::bit_width(around_edge) - 1;
}

/// Copies of the vertex on a node of the domain's border, and which of them each border face at the node uses.
///
/// A border face at a node is named by the present cell behind it (`octant`, its bit around the node) and the axis of
/// its normal. Faces belong to one copy when a walk round the node, through present cells only, leads from one to the
/// other: then every copy has a single fan of faces.
struct NodeCopies {
  int count = 0;
  std::array<std::array<std::int8_t, 3>, 8> copy{};  ///< [octant][axis]; -1 where that face is not on the border
};

/// around_node   all 8 cells present or none: no vertex, count = 0.
const NodeCopies& node_copies(unsigned around_node);

/// Cells around a node by what is joined across faces: the pieces of the solid that the node belongs to.
struct CellGroups {
  int count = 0;
  std::array<std::int8_t, 8> group{};  ///< [octant], numbered by lowest octant; -1 where the cell is absent
};

const CellGroups& cell_groups(unsigned around_node);

}  // namespace contact
}  // namespace geosis
