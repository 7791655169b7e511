#pragma once

#include <array>
#include <cstdint>

/// Topology of one cell, from sums, products, quotients and comparisons of a Number: long double, quick and with a
/// margin for its rounding, or mpq_class of GMP, which is exact.
namespace geosis::test {

/// Where a value lies with regard to the range [v, w]; a value on an end is inside.
enum class Side : std::uint8_t { below, inside, above };

/// The two closed sets that the body leaves over: {f < v} and {f > w}, closed by moving v and w outwards a little.
enum Outside : int { kBelow = 0, kAbove = 1 };
inline constexpr int kOutsides = 2;

/// One corner of a cell: its side, and how far it lies in each of the two sets (positive inside the set).
template <class Number>
struct CornerValue {
  Side side = Side::inside;
  std::array<Number, kOutsides> excess{};

  bool in(int outside) const { return side == (outside == kBelow ? Side::below : Side::above); }
};

/// Corner (a, b, c) of a cell is at a * 4 + b * 2 + c, with a along the inline axis and c along the sample axis.
template <class Number>
using CellCorners = std::array<CornerValue<Number>, 8>;
/// The corners of a square in cyclic order.
template <class Number>
using SquareCorners = std::array<CornerValue<Number>, 4>;

/// Number of an edge of the cell: along axis d, at offsets (p, q) on the other two axes in ascending order.
constexpr int cell_edge(int d, int p, int q) {
  return d * 4 + p * 2 + q;
}

/// What a square shows of one of the two sets.
struct SquarePattern {
  std::array<bool, 4> in{};  ///< corners in the set
  bool joined = false;       ///< of two opposite corners in the set: connected through the square

  int corners_in() const { return in[0] + in[1] + in[2] + in[3]; }
  bool is_diagonal() const { return corners_in() == 2 && in[0] == in[2]; }
};

/// Two corners of opposite sides that the saddle connects, or not, or (`tied`) on the end of the range as far as the
/// Number can tell.
struct SquareDecision {
  SquarePattern pattern;
  bool tied = false;
};
template <class Number>
SquareDecision decide_square(const SquareCorners<Number>& corners, int outside);

/// Euler characteristic with compact supports of the set in the open square.
int open_square_euler(const SquarePattern& pattern);

/// Topology of one cell, f trilinear inside.
struct CellTopology {
  bool decided = true;  ///< false: a saddle inside the cell lies on an end of the range, as far as the Number can tell
  /// Euler characteristic with compact supports of each set in the open cell.
  std::array<int, kOutsides> open_euler{};
  /// Component of {v <= f <= w} in the closed cell that the band on each edge belongs to, -1 where the edge has none.
  /// Every component meets an edge.
  std::array<std::int8_t, 12> band_of_edge{};
  int bands = 0;
  /// Component of {f < v} or {f > w} in the closed cell that each corner belongs to, -1 for corners inside.
  std::array<std::int8_t, 8> rest_of_corner{};
};
template <class Number>
CellTopology cell_topology(const CellCorners<Number>& corners);

}  // namespace geosis::test
