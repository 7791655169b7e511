#include "engine/isosurface/generator/cell_loops.h"

#include <algorithm>

#include "engine/isosurface/cell.h"

namespace geosis::generator {
namespace {

bool is_above(std::uint8_t above, int corner) {
  return (above >> corner) & 1;
}

/// Corners 0..3 of a face, counter-clockwise for somebody outside the cell.
std::array<int, 4> corners_from_outside(int face) {
  std::array<int, 4> corners{};
  for (int m = 0; m < 4; ++m) {
    corners[m] = cell::face_corner(face, cell::frame_is_counter_clockwise(face) ? m : 3 - m);
  }
  return corners;
}

/// Successor of each crossed edge on its loop, -1 where an edge is not crossed. A segment of a face starts on the edge
/// that leads (counter-clockwise) from below to above and ends on one that leads back.
std::array<int, 12> loop_successors(std::uint8_t above, std::uint8_t joined_faces) {
  std::array<int, 12> next;
  next.fill(-1);
  for (int face = 0; face < cell::kFaces; ++face) {
    const auto corner = corners_from_outside(face);
    const bool joined = cell::is_ambiguous(above, face) && ((joined_faces >> face) & 1);
    const auto edge = [&](int m) { return cell::edge_between(corner[m & 3], corner[(m + 1) & 3]); };
    for (int m = 0; m < 4; ++m) {
      if (is_above(above, corner[m]) || !is_above(above, corner[(m + 1) & 3])) continue;
      // Enters above on edge m. Separated: leaves after the run of corners above; joined: hugs the corner below.
      int end = joined ? m + 3 : m + 1;
      while (!joined && is_above(above, corner[(end + 1) & 3])) ++end;
      next[edge(m)] = edge(end);
    }
  }
  return next;
}

std::array<int, 8> corner_regions(std::uint8_t above, std::uint8_t joined_faces) {
  std::array<int, 8> region{};
  for (int c = 0; c < 8; ++c) region[c] = c;
  const auto join = [&](int a, int b) {
    const int from = std::max(region[a], region[b]), to = std::min(region[a], region[b]);
    for (int& r : region) r = r == from ? to : r;
  };
  for (int e = 0; e < cell::kEdges; ++e) {
    const int a = cell::edge_start(e), b = cell::edge_end(e);
    if (is_above(above, a) == is_above(above, b)) join(a, b);
  }
  for (int face = 0; face < cell::kFaces; ++face) {
    if (!cell::is_ambiguous(above, face)) continue;
    const bool diagonal_above = (joined_faces >> face) & 1;
    const int start = is_above(above, cell::face_corner(face, 0)) == diagonal_above ? 0 : 1;
    join(cell::face_corner(face, start), cell::face_corner(face, start + 2));
  }
  return region;
}

}  // namespace

CellLoops trace_loops(std::uint8_t above, std::uint8_t joined_faces) {
  CellLoops cell;
  cell.region = corner_regions(above, joined_faces);
  auto next = loop_successors(above, joined_faces);
  for (int start = 0; start < cell::kEdges; ++start) {
    if (next[start] < 0) continue;
    std::vector<int> loop;
    for (int e = start; next[e] >= 0;) {
      loop.push_back(e);
      const int following = next[e];
      next[e] = -1;
      e = following;
    }
    const int a = cell::edge_start(start), b = cell::edge_end(start);
    cell.above.push_back(cell.region[is_above(above, a) ? a : b]);
    cell.below.push_back(cell.region[is_above(above, a) ? b : a]);
    cell.loops.push_back(std::move(loop));
  }
  return cell;
}

bool is_segment(const CellLoops& cell, int a, int b) {
  for (const auto& loop : cell.loops) {
    for (std::size_t n = 0; n < loop.size(); ++n) {
      const int p = loop[n], q = loop[(n + 1) % loop.size()];
      if ((p == a && q == b) || (p == b && q == a)) return true;
    }
  }
  return false;
}

}  // namespace geosis::generator
