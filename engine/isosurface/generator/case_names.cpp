#include "engine/isosurface/generator/case_names.h"

#include <algorithm>
#include <array>
#include <bit>

#include "engine/isosurface/cell.h"
#include "engine/isosurface/generator/cell_loops.h"

namespace geosis::generator {
namespace {

/// Marked corners: those of the rarer sign.
unsigned marked_corners(std::uint8_t above) {
  return std::popcount(above) <= 4 ? above : 0xffu & ~above;
}

std::vector<int> neighbours(unsigned marked, int corner) {
  std::vector<int> found;
  for (int axis = 0; axis < 3; ++axis) {
    const int other = corner ^ cell::corner_bit(axis);
    if ((marked >> other) & 1) found.push_back(other);
  }
  return found;
}

std::array<int, 3> direction(int from, int to) {
  const auto offset = [&](int bit) { return ((to & bit) ? 1 : 0) - ((from & bit) ? 1 : 0); };
  return {offset(4), offset(2), offset(1)};
}

int determinant(std::array<int, 3> a, std::array<int, 3> b, std::array<int, 3> c) {
  return a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
}

/// Base case of a path of four corners that does not lie in a plane.
int path_case(unsigned marked) {
  int end = 0;
  while (!((marked >> end) & 1) || neighbours(marked, end).size() != 1) ++end;
  std::array<int, 4> path = {end, neighbours(marked, end).front(), 0, 0};
  for (int n = 2; n < 4; ++n) {
    for (int next : neighbours(marked, path[n - 1])) {
      if (next != path[n - 2]) path[n] = next;
    }
  }
  const int turn = determinant(direction(path[0], path[1]), direction(path[1], path[2]), direction(path[2], path[3]));
  return turn > 0 ? 11 : 14;
}

int base_case(unsigned marked) {
  int edges = 0, most = 0, distance = 0;
  for (int a = 0; a < cell::kCorners; ++a) {
    if (!((marked >> a) & 1)) continue;
    const int degree = static_cast<int>(neighbours(marked, a).size());
    edges += degree;
    most = std::max(most, degree);
    for (int b = 0; b < a; ++b) {
      if ((marked >> b) & 1) distance = std::max(distance, std::popcount(static_cast<unsigned>(a ^ b)));
    }
  }
  edges /= 2;
  switch (std::popcount(marked)) {
    case 0:
      return 0;
    case 1:
      return 1;
    case 2:
      return 1 + distance;
    case 3:
      return edges == 2 ? 5 : edges == 1 ? 6 : 7;
    default:
      break;
  }
  switch (edges) {
    case 4:
      return 8;
    case 3:
      return most == 3 ? 9 : path_case(marked);
    case 2:
      return most == 2 ? 12 : 10;
    default:
      return 13;
  }
}

/// 12.2 or 12.3: which of the two ambiguous faces joins the corners above.
std::string one_face_of_12(const CellState& state, unsigned marked) {
  int single = 0;
  while (!((marked >> single) & 1) || !neighbours(marked, single).empty()) ++single;
  std::array<int, 3> joined{}, separated{};
  const std::uint8_t ambiguous = cell::ambiguous_faces(state.above);
  for (int face = 0; face < cell::kFaces; ++face) {
    if (!((ambiguous >> face) & 1)) continue;
    std::array<int, 3> outwards{};
    outwards[cell::face_axis(face)] = cell::face_side(face) ? 1 : -1;
    (((state.joined_faces >> face) & 1) ? joined : separated) = outwards;
  }
  // The face that is not ambiguous and holds the single corner: outwards from the cell's other end.
  std::array<int, 3> up{};
  for (int axis = 0; axis < 3; ++axis) {
    if (joined[axis] == 0 && separated[axis] == 0) up[axis] = (single & cell::corner_bit(axis)) ? 1 : -1;
  }
  return determinant(joined, separated, up) > 0 ? "12.2" : "12.3";
}

std::string subcase_of_13(const CellState& state, int joined) {
  if (joined == 0 || joined == 6) return "13.1";
  if (joined == 1 || joined == 5) return "13.2";
  if (joined == 2 || joined == 4) return "13.3";
  if (trace_loops(state.above, state.joined_faces).loops.size() == 1) return "13.4";
  return state.tunnel == Tunnel::none ? "13.5.1" : "13.5.2";
}

}  // namespace

const std::vector<std::string>& subcase_names() {
  static const std::vector<std::string> kNames = {
      "0",      "1",      "2",    "3.1",   "3.2",   "4.1.1", "4.1.2", "5",      "6.1.1",  "6.1.2",  "6.2",
      "7.1",    "7.2",    "7.3",  "7.4.1", "7.4.2", "8",     "9",     "10.1.1", "10.1.2", "10.2",   "11",
      "12.1.1", "12.1.2", "12.2", "12.3",  "13.1",  "13.2",  "13.3",  "13.4",   "13.5.1", "13.5.2", "14"};
  return kNames;
}

std::string subcase_of(const CellState& state) {
  const unsigned marked = marked_corners(state.above);
  const int base = base_case(marked);
  const int ambiguous = std::popcount(cell::ambiguous_faces(state.above));
  const int joined_above = std::popcount(state.joined_faces);
  const int joined = marked == state.above ? joined_above : ambiguous - joined_above;  // of the marked corners
  const std::string last = state.tunnel == Tunnel::none ? ".1" : ".2";
  switch (base) {
    case 3:
      return joined == 0 ? "3.1" : "3.2";
    case 4:
      return "4.1" + last;
    case 6:
      return joined == 0 ? "6.1" + last : "6.2";
    case 7:
      return joined == 3 ? "7.4" + last : "7." + std::to_string(joined + 1);
    case 10:
      return joined == 1 ? "10.2" : "10.1" + last;
    case 12:
      return joined == 1 ? one_face_of_12(state, marked) : "12.1" + last;
    case 13:
      return subcase_of_13(state, joined_above);
    default:
      return std::to_string(base);
  }
}

}  // namespace geosis::generator
