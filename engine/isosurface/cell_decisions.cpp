#include "engine/isosurface/cell_decisions.h"

#include "engine/isosurface/cell.h"
#include "engine/isosurface/exact_sign.h"

namespace geosis {
namespace {

int sign_of(const Bounded& x) {
  return x.value > 0 ? 1 : x.value < 0 ? -1 : 0;
}
bool decides(const Bounded& x) {
  return x.decides();
}
int sign_of(const Exact& x) {
  return x.sign();
}
bool decides(const Exact&) {
  return true;
}

/// A C - B D of the differences to the level, around a face.
template <class Number>
Number face_determinant(const CellValues& cell, int face) {
  const Number level(cell.level);
  const auto difference = [&](int m) { return Number(cell.value[cell::face_corner(face, m)]) - level; };
  return difference(0) * difference(2) - difference(1) * difference(3);
}

int face_determinant_sign(const CellValues& cell, int face) {
  const Bounded estimate = face_determinant<Bounded>(cell, face);
  return estimate.decides() ? sign_of(estimate) : sign_of(face_determinant<Exact>(cell, face));
}

// Vertical edges of the cell in cyclic order: bottom corner; the top corner is one more.
constexpr std::array<int, 4> kPillar = {0, 4, 6, 2};

/// Signs that place the extremum of F(t) = A(t) C(t) - B(t) D(t) between the bottom (t = 0) and the top face (t = 1).
struct SliceSigns {
  bool decided = false;
  int curvature = 0;          ///< of F: sign of its quadratic coefficient a
  bool inside = false;        ///< the extremum lies at 0 < t < 1
  int discriminant = 0;       ///< of b^2 - 4 a c: positive when F changes sign around the extremum
  std::array<int, 2> ends{};  ///< signs, at the extremum, of the two pillars that F could join there
};

template <class Number>
SliceSigns slice_signs(const CellValues& cell) {
  std::array<Number, 4> low, rise;
  const Number level(cell.level);
  for (int p = 0; p < 4; ++p) {
    const Number bottom(cell.value[kPillar[p]]), top(cell.value[kPillar[p] + 1]);
    low[p] = bottom - level;
    rise[p] = top - bottom;
  }
  const Number a = rise[0] * rise[2] - rise[1] * rise[3];
  const Number b = (low[0] * rise[2] + low[2] * rise[0]) - (low[1] * rise[3] + low[3] * rise[1]);
  const Number c = low[0] * low[2] - low[1] * low[3];
  const Number two_a = a + a, end = two_a + b;
  const Number discriminant = b * b - (two_a + two_a) * c;

  SliceSigns signs;
  signs.curvature = sign_of(a);
  const int first = signs.curvature < 0 ? 0 : 1;  // a < 0: A and C can be joined; a > 0: B and D
  const Number at_first = two_a * low[first] - b * rise[first];
  const Number at_second = two_a * low[first + 2] - b * rise[first + 2];
  signs.decided =
      decides(a) && decides(b) && decides(end) && decides(discriminant) && decides(at_first) && decides(at_second);
  signs.inside = sign_of(b) == -signs.curvature && sign_of(end) == signs.curvature;
  signs.discriminant = sign_of(discriminant);
  signs.ends = {signs.curvature * sign_of(at_first), signs.curvature * sign_of(at_second)};
  return signs;
}

}  // namespace

bool above_joined_on_face(const CellValues& cell, std::uint8_t above, int face) {
  int sign = face_determinant_sign(cell, face);
  if (!((above >> cell::face_corner(face, 0)) & 1)) sign = -sign;
  return sign > 0 || (sign == 0 && cell.ties_above);
}

std::uint8_t joined_faces(const CellValues& cell, std::uint8_t above, std::uint8_t ambiguous_faces) {
  unsigned joined = 0;
  for (int face = 0; face < cell::kFaces; ++face) {
    if ((ambiguous_faces >> face) & 1) joined |= unsigned{above_joined_on_face(cell, above, face)} << face;
  }
  return static_cast<std::uint8_t>(joined);
}

InteriorJoint interior_joint(const CellValues& cell, std::uint8_t above) {
  SliceSigns signs = slice_signs<Bounded>(cell);
  if (!signs.decided) signs = slice_signs<Exact>(cell);
  if (signs.curvature == 0 || !signs.inside || signs.discriminant < 0) return {};
  if (signs.ends[0] == 0 || signs.ends[0] != signs.ends[1]) return {};
  const bool joins_above = signs.ends[0] > 0;
  if (signs.discriminant == 0 && joins_above != cell.ties_above) return {};  // the saddle lies on the level

  const auto corner_of = [&](int pillar) {
    const int bottom = kPillar[pillar];
    return ((above >> bottom) & 1) == (joins_above ? 1 : 0) ? bottom : bottom + 1;
  };
  const int first = signs.curvature < 0 ? 0 : 1;
  return {.joined = true, .above = joins_above, .first = corner_of(first), .second = corner_of(first + 2)};
}

}  // namespace geosis
