#pragma once

#include <array>
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

}  // namespace contact
}  // namespace geosis
