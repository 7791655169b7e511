#include "engine/isosurface/join_bodies.h"

#include <algorithm>
#include <limits>

namespace geosis {
namespace {

/// A layer as one of the two bricks that share it knows it, and where that brick's pieces begin.
struct LayerSide {
  const BrickBodies* part = nullptr;
  const SharedLayer* layer = nullptr;
  std::int32_t first_piece = 0;
};

void join_lists(const std::vector<std::int32_t>& below, std::int32_t first_below,
                const std::vector<std::int32_t>& above, std::int32_t first_above, DisjointSets& sets) {
  const std::size_t count = std::min(below.size(), above.size());
  for (std::size_t n = 0; n < count; ++n) sets.unite(first_below + below[n], first_above + above[n]);
}

void join_rows(const LayerSide& below, const LayerSide& above, DisjointSets& sets) {
  const std::size_t rows = std::min(below.layer->rows.size(), above.layer->rows.size());
  for (std::size_t m = 0; m < rows; ++m) {
    const SharedLayer::Row &one = below.layer->rows[m], &other = above.layer->rows[m];
    const std::uint64_t nodes = one.nodes & other.nodes;
    each_bit(nodes & (~(nodes << 1) | one.starts | other.starts), [&](int n) {
      sets.unite(below.first_piece + below.layer->piece[one.run(n)],
                 above.first_piece + above.layer->piece[other.run(n)]);
    });
  }
}

/// All nodes of a whole brick are its one piece.
void join_to_whole(const LayerSide& whole, const LayerSide& side, DisjointSets& sets) {
  if (side.part->is_whole) return sets.unite(whole.first_piece, side.first_piece);
  for (const std::int32_t piece : side.layer->piece) sets.unite(whole.first_piece, side.first_piece + piece);
}

void join_layer(const LayerSide& below, const LayerSide& above, DisjointSets& sets) {
  if (below.part->is_whole) return join_to_whole(below, above, sets);
  if (above.part->is_whole) return join_to_whole(above, below, sets);
  join_lists(below.layer->of_vertex, below.first_piece, above.layer->of_vertex, above.first_piece, sets);
  join_lists(below.layer->of_contact, below.first_piece, above.layer->of_contact, above.first_piece, sets);
  join_rows(below, above, sets);
}

}  // namespace

Result<JoinedBodies> join_bodies(const BrickLayout& layout, const std::vector<std::size_t>& bricks,
                                 const std::vector<BrickBodies>& parts) {
  constexpr std::int32_t kAbsent = -1;
  std::vector<std::int32_t> slot(layout.brick_count(), kAbsent);
  JoinedBodies joined;
  std::int64_t pieces = 0;
  for (std::size_t n = 0; n < parts.size(); ++n) {
    slot[bricks[n]] = static_cast<std::int32_t>(n);
    joined.first_piece.push_back(static_cast<std::int32_t>(pieces));
    pieces += parts[n].pieces;
    if (pieces > std::numeric_limits<std::int32_t>::max()) {
      return Error{ErrorCode::limit_exceeded, "the solid falls into more pieces than can be counted"};
    }
  }
  DisjointSets sets;
  sets.reset(static_cast<std::int32_t>(pieces));
  for (std::size_t n = 0; n < parts.size(); ++n) {
    for (int axis = 0; axis < 3; ++axis) {
      GridIndex place = layout.place(bricks[n]);
      if (++place[axis] >= layout.grid()[axis]) continue;
      const std::int32_t next = slot[layout.number(place)];
      if (next == kAbsent) continue;
      join_layer({&parts[n], &parts[n].layers[axis][1], joined.first_piece[n]},
                 {&parts[next], &parts[next].layers[axis][0], joined.first_piece[next]}, sets);
    }
  }
  joined.count = sets.number_sets(joined.body);
  return joined;
}

}  // namespace geosis
