#include "engine/isosurface/cap_face.h"

#include <array>
#include <map>

#include <gtest/gtest.h>

namespace geosis {
namespace {

/// Place of a cap vertex in the unit square; a sheet's crossings lie at a third or two thirds, sheet 0 nearer below.
std::array<double, 2> place_of(const CapVertex& v, const CapFace& face) {
  constexpr std::array<std::array<double, 2>, 4> kCorners = {{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
  if (v.kind == CapVertex::Kind::node) return kCorners[v.place];
  const auto &p = kCorners[v.place], &q = kCorners[(v.place + 1) & 3];
  double t = 0.5;
  if (v.kind == CapVertex::Kind::crossing && face.sheets == 2) {
    const bool rises = !((face.above[v.sheet] >> v.place) & 1);
    t = (v.sheet == 0) == rises ? 1.0 / 3 : 2.0 / 3;
  }
  return {p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1])};
}

double signed_area(const CapTriangles& cap, const CapFace& face) {
  double area = 0;
  for (int n = 0; n < cap.count; ++n) {
    const auto p = place_of(cap.triangle[n][0], face), q = place_of(cap.triangle[n][1], face),
               r = place_of(cap.triangle[n][2], face);
    area += ((q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])) / 2;
  }
  return area;
}

using Key = std::array<int, 3>;
Key key_of(const CapVertex& v) {
  return {static_cast<int>(v.kind), v.sheet, v.place};
}

/// Each class of corner: 0 below, 1 inside, 2 above the band.
CapFace band_face(int face, std::array<int, 4> corner, bool low_joined, bool high_joined) {
  CapFace cap{.face = face, .sheets = 2, .body_is_above = {true, false}, .joined = {low_joined, high_joined}};
  for (int m = 0; m < 4; ++m) {
    cap.above[0] = static_cast<std::uint8_t>(cap.above[0] | (corner[m] >= 1) << m);
    cap.above[1] = static_cast<std::uint8_t>(cap.above[1] | (corner[m] == 2) << m);
    cap.inside = static_cast<std::uint8_t>(cap.inside | (corner[m] == 1) << m);
  }
  return cap;
}

template <class Visit>
void each_band_face(Visit&& visit) {
  for (int face = 0; face < 6; ++face) {
    for (int code = 0; code < 81; ++code) {
      const std::array<int, 4> corner = {code % 3, code / 3 % 3, code / 9 % 3, code / 27};
      // {f > high} joined across the face implies {f >= low} joined.
      visit(band_face(face, corner, false, false));
      visit(band_face(face, corner, true, false));
      visit(band_face(face, corner, true, true));
    }
  }
}

bool alternates(std::uint8_t above) {
  return (above & 15) == 5 || (above & 15) == 10;
}

TEST(CapFace, FacesWithoutBodyStayOpen) {
  EXPECT_EQ(cap_face(band_face(1, {0, 0, 0, 0}, true, true)).count, 0);
  EXPECT_EQ(cap_face(band_face(1, {2, 2, 2, 2}, true, true)).count, 0);
}

TEST(CapFace, WholeFaceIsTwoTrianglesOutwards) {
  for (int face = 0; face < 6; ++face) {
    const CapFace cap = band_face(face, {1, 1, 1, 1}, true, true);
    EXPECT_EQ(cap_face(cap).count, 2);
    EXPECT_DOUBLE_EQ(signed_area(cap_face(cap), cap), cell::frame_is_counter_clockwise(face) ? 1 : -1);
  }
}

TEST(CapFace, EveryBandIsAManifoldWithoutFlatOrTurnedTriangles) {
  each_band_face([](const CapFace& face) {
    const CapTriangles cap = cap_face(face);
    std::map<std::pair<Key, Key>, int> edges;
    for (int n = 0; n < cap.count; ++n) {
      CapTriangles one{.count = 1};
      one.triangle[0] = cap.triangle[n];
      const double area = signed_area(one, face);
      EXPECT_GT(cell::frame_is_counter_clockwise(face.face) ? area : -area, 1e-9);
      for (int m = 0; m < 3; ++m) ++edges[{key_of(cap.triangle[n][m]), key_of(cap.triangle[n][(m + 1) % 3])}];
    }
    for (const auto& [edge, count] : edges) EXPECT_EQ(count, 1);
  });
}

TEST(CapFace, DrawsNoChordThatThePresentCellMayDraw) {
  each_band_face([](const CapFace& face) {
    const CapTriangles cap = cap_face(face);
    std::map<std::pair<Key, Key>, int> edges;
    for (int n = 0; n < cap.count; ++n) {
      for (int m = 0; m < 3; ++m) ++edges[{key_of(cap.triangle[n][m]), key_of(cap.triangle[n][(m + 1) % 3])}];
    }
    for (const auto& [edge, count] : edges) {
      const auto& [a, b] = edge;
      const bool is_chord = edges.contains({b, a});
      const bool one_sheet = a[0] == 1 && b[0] == 1 && a[1] == b[1];
      if (!is_chord || !one_sheet) continue;
      const chord::FaceState state{.first_above = (face.above[a[1]] & 1) != 0, .joined_above = face.joined[a[1]]};
      EXPECT_FALSE(chord::allowed(face.face, state, a[2], b[2]));
    }
  });
}

TEST(CapFace, BodyAndRestFillTheFace) {
  // Without alternating corners the strips' areas are known from the crossings alone: low part + band + high part = 1.
  each_band_face([](const CapFace& face) {
    if (alternates(face.above[0]) || alternates(face.above[1])) return;
    CapFace above_low = face, below_high = face;
    above_low.inside = face.above[0];
    above_low.above[1] = 0;
    below_high.above[0] = 15;
    below_high.inside = static_cast<std::uint8_t>(~face.above[1] & 15);
    const double band = signed_area(cap_face(face), face), high = signed_area(cap_face(above_low), above_low),
                 low = signed_area(cap_face(below_high), below_high);
    const double whole = cell::frame_is_counter_clockwise(face.face) ? 1 : -1;
    EXPECT_NEAR(high + low - band, whole, 1e-12);
  });
}

TEST(CapFace, MiddlesOfContactEdgesAreUsed) {
  CapFace face = band_face(3, {1, 1, 1, 1}, true, true);
  face.contact_edges = 0b0101;
  const CapTriangles cap = cap_face(face);
  EXPECT_EQ(cap.count, 4);
  EXPECT_NEAR(signed_area(cap, face), cell::frame_is_counter_clockwise(3) ? 1 : -1, 1e-12);
}

}  // namespace
}  // namespace geosis
