#pragma once

#include <array>
#include <cstdint>

namespace geosis {

/// Numbering of one cell's corners, edges and faces: the one convention of tables, decisions and meshers.
///
///   corner c    = 4 di + 2 dj + dk: the node (i + di, j + dj, k + dk)
///   edge e      = 4 axis + n: runs along `axis` (0 = i, 1 = j, 2 = k) from the corner whose two other offsets, in
///                 axis order, are the bits of n
///   face f      = 2 axis + side: the four corners whose offset along `axis` is `side`
///
/// On a face, with the in-plane axes b < c of its normal axis, corners go (0,0) (1,0) (1,1) (0,1) in (b, c) and edge m
/// joins corner m to corner m + 1: the same frame for both cells that share the face.
namespace cell {

inline constexpr int kCorners = 8, kEdges = 12, kFaces = 6;

/// Offset bit of an axis inside a corner number.
constexpr int corner_bit(int axis) {
  return 4 >> axis;
}
/// In-plane axes of a face (or the two axes across an edge), in order.
constexpr int first_axis(int normal) {
  return normal == 0 ? 1 : 0;
}
constexpr int second_axis(int normal) {
  return normal == 2 ? 1 : 2;
}

constexpr int edge_axis(int edge) {
  return edge >> 2;
}
/// The corner where an edge starts (lower index along its axis).
constexpr int edge_start(int edge) {
  const int axis = edge_axis(edge);
  return ((edge & 2) ? corner_bit(first_axis(axis)) : 0) + ((edge & 1) ? corner_bit(second_axis(axis)) : 0);
}
constexpr int edge_end(int edge) {
  return edge_start(edge) + corner_bit(edge_axis(edge));
}

constexpr int edge_between(int a, int b) {
  for (int e = 0; e < kEdges; ++e) {
    if ((edge_start(e) == a && edge_end(e) == b) || (edge_start(e) == b && edge_end(e) == a)) return e;
  }
  return -1;
}

constexpr int face_axis(int face) {
  return face >> 1;
}
constexpr int face_side(int face) {
  return face & 1;
}

/// Corner m (0..3) of a face, in the face's frame.
constexpr int face_corner(int face, int m) {
  const int axis = face_axis(face);
  const bool b = m == 1 || m == 2, c = m >= 2;
  return (face_side(face) ? corner_bit(axis) : 0) + (b ? corner_bit(first_axis(axis)) : 0) +
         (c ? corner_bit(second_axis(axis)) : 0);
}
/// Edge m (0..3) of a face: from its corner m to corner m + 1.
constexpr int face_edge(int face, int m) {
  return edge_between(face_corner(face, m), face_corner(face, (m + 1) & 3));
}

/// Whether the frame's order of corners is counter-clockwise for somebody outside the cell.
constexpr bool frame_is_counter_clockwise(int face) {
  const bool right_handed = face_axis(face) != 1;  // b x c = +normal for normals i and k, -normal for j
  return right_handed == (face_side(face) == 1);
}

/// A face is ambiguous when its corners alternate.
constexpr bool is_ambiguous(std::uint8_t above, int face) {
  const auto bit = [&](int m) { return (above >> face_corner(face, m)) & 1; };
  return bit(0) != bit(1) && bit(1) != bit(2) && bit(2) != bit(3);
}

/// The ambiguous faces of a sign mask, as bits.
constexpr std::uint8_t ambiguous_faces(std::uint8_t above) {
  std::uint8_t faces = 0;
  for (int f = 0; f < kFaces; ++f) faces = static_cast<std::uint8_t>(faces | (is_ambiguous(above, f) << f));
  return faces;
}

}  // namespace cell

/// Chords that lie in a face. Two cells share it, and each may use only its own half of the chord types, so that no
/// chord is ever drawn from both sides (an edge with four triangles). Bit (m, n), m < n: chord between edges m and n of
/// the face's frame.
namespace chord {

constexpr int type(int m, int n) {
  constexpr int kTypes[4][4] = {{-1, 0, 1, 2}, {0, -1, 3, 4}, {1, 3, -1, 5}, {2, 4, 5, -1}};
  return kTypes[m][n];
}

/// How the level lies in an ambiguous face: only there do chords exist. Both cells know it.
struct FaceState {
  bool first_above = false;   ///< corner 0 (and 2) of its frame lies above the level, else 1 and 3
  bool joined_above = false;  ///< the two corners above are joined
};

/// By the face's axis and state (2 first_above + joined_above): chord types of the cell that sees the face as its side
/// 1 (the face lies above it); the other types are those of the cell beyond. Found by simulated annealing over all such
/// splits: the fewest states whose tunnel cannot be drawn without a cut in some of a thousand geometries
/// (docs/adr/0010).
inline constexpr std::uint8_t kOfLowerCell[3][4] = {
    {0x0b, 0x35, 0x1d, 0x22}, {0x0f, 0x10, 0x14, 0x3c}, {0x30, 0x03, 0x2f, 0x19}};

constexpr bool allowed(int face, FaceState state, int m, int n) {
  const int lower = kOfLowerCell[cell::face_axis(face)][2 * state.first_above + state.joined_above];
  return ((cell::face_side(face) == 1 ? lower : ~lower) >> type(m, n)) & 1;
}

}  // namespace chord

}  // namespace geosis
