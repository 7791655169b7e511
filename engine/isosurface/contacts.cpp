#include "engine/isosurface/contacts.h"

#include <algorithm>

#include "engine/isosurface/cell.h"

namespace geosis::contact {
namespace {

bool is_present(unsigned cells, int octant) {
  return (cells >> octant) & 1;
}

bool is_border(unsigned cells, int octant, int axis) {
  return is_present(cells, octant) && !is_present(cells, octant ^ cell::corner_bit(axis));
}

/// The border face that follows (octant, axis) across the half-edge along the third axis: turn about it through present
/// cells until the next border face.
std::pair<int, int> next_face(unsigned cells, int octant, int axis, int turn_axis) {
  int toward = 3 - axis - turn_axis;
  while (is_present(cells, octant ^ cell::corner_bit(toward))) {
    octant ^= cell::corner_bit(toward);
    toward = 3 - turn_axis - toward;
  }
  return {octant, toward};
}

NodeCopies make_copies(unsigned cells) {
  constexpr int kFaces = 24;
  std::array<int, kFaces> group{};
  for (int n = 0; n < kFaces; ++n) group[n] = n;
  const auto each_border = [&](auto&& visit) {
    for (int n = 0; n < kFaces; ++n) {
      if (is_border(cells, n / 3, n % 3)) visit(n / 3, n % 3);
    }
  };
  each_border([&](int octant, int axis) {
    for (int turn = 0; turn < 3; ++turn) {
      if (turn == axis) continue;
      const auto [next_octant, next_axis] = next_face(cells, octant, axis, turn);
      const int a = group[octant * 3 + axis], b = group[next_octant * 3 + next_axis];
      for (int& g : group) g = g == std::max(a, b) ? std::min(a, b) : g;
    }
  });

  NodeCopies copies;
  for (auto& faces : copies.copy) faces.fill(-1);
  std::array<int, kFaces> number;
  number.fill(-1);
  each_border([&](int octant, int axis) {
    int& copy = number[group[octant * 3 + axis]];
    if (copy < 0) copy = copies.count++;
    copies.copy[octant][axis] = static_cast<std::int8_t>(copy);
  });
  return copies;
}

/// Gives the cell and all it is joined to, across faces, the group's number.
void spread_group(unsigned cells, int octant, std::int8_t number, CellGroups& groups) {
  if (!is_present(cells, octant) || groups.group[octant] >= 0) return;
  groups.group[octant] = number;
  for (int axis = 0; axis < 3; ++axis) spread_group(cells, octant ^ cell::corner_bit(axis), number, groups);
}

CellGroups make_groups(unsigned cells) {
  CellGroups groups;
  groups.group.fill(-1);
  for (int octant = 0; octant < 8; ++octant) {
    if (!is_present(cells, octant) || groups.group[octant] >= 0) continue;
    spread_group(cells, octant, static_cast<std::int8_t>(groups.count++), groups);
  }
  return groups;
}

template <class Entry>
std::array<Entry, 256> make_table(Entry (*make)(unsigned)) {
  std::array<Entry, 256> all;
  for (unsigned cells = 0; cells < 256; ++cells) all[cells] = make(cells);
  return all;
}

}  // namespace

const NodeCopies& node_copies(unsigned around_node) {
  static const std::array<NodeCopies, 256> all = make_table(make_copies);
  return all[around_node];
}

const CellGroups& cell_groups(unsigned around_node) {
  static const std::array<CellGroups, 256> all = make_table(make_groups);
  return all[around_node];
}

}  // namespace geosis::contact
