#include "engine/isosurface/cap_face.h"

#include <cassert>
#include <utility>

namespace geosis {
namespace {

using Kind = CapVertex::Kind;

/// Points of the face's outline in the frame's order, at most 4 nodes, 8 crossings and 4 middles.
struct OutlinePoint {
  CapVertex vertex;
  bool enters = false, leaves = false;  ///< the body begins or ends here, in the frame's direction
};

struct Outline {
  int count = 0;
  std::array<OutlinePoint, 16> point{};
  void add(OutlinePoint p) { point[count++] = p; }
};

bool bit(unsigned bits, int m) {
  return (bits >> (m & 3)) & 1;
}

bool crosses(const CapFace& face, int sheet, int edge) {
  return bit(face.above[sheet], edge) != bit(face.above[sheet], edge + 1);
}

/// Body just after the crossing of `sheet` on `edge`, going in the frame's direction.
bool enters_at(const CapFace& face, int sheet, int edge) {
  return bit(face.above[sheet], edge + 1) == face.body_is_above[sheet];
}

Outline trace_outline(const CapFace& face) {
  Outline outline;
  for (int m = 0; m < 4; ++m) {
    const bool inside = bit(face.inside, m), next_inside = bit(face.inside, m + 1);
    const auto place = static_cast<std::uint8_t>(m);
    if (inside) outline.add({.vertex = {Kind::node, 0, place}});
    if (inside && next_inside && bit(face.contact_edges, m)) outline.add({.vertex = {Kind::middle, 0, place}});
    // Two sheets on one edge are met in the order of their levels: the first one first on the way up.
    const bool falls = face.sheets == 2 && bit(face.above[0], m) && !bit(face.above[0], m + 1);
    for (int n = 0; n < face.sheets; ++n) {
      const int sheet = falls ? face.sheets - 1 - n : n;
      if (!crosses(face, sheet, m)) continue;
      const bool enters = enters_at(face, sheet, m);
      outline.add(
          {.vertex = {Kind::crossing, static_cast<std::uint8_t>(sheet), place}, .enters = enters, .leaves = !enters});
    }
  }
  return outline;
}

/// The other end of the sheet's segment that starts on `edge`.
int segment_end(const CapFace& face, int sheet, int edge) {
  int crossings = 0, other = -1;
  for (int m = 0; m < 4; ++m) {
    if (!crosses(face, sheet, m)) continue;
    ++crossings;
    if (m != edge) other = m;
  }
  if (crossings == 2) return other;
  // Alternating corners: each segment goes round one corner, below if those above are joined.
  const bool round_this_corner = bit(face.above[sheet], edge) != face.joined[sheet];
  return round_this_corner ? (edge + 3) & 3 : (edge + 1) & 3;
}

int find_crossing(const Outline& outline, int sheet, int edge) {
  for (int n = 0; n < outline.count; ++n) {
    const CapVertex& v = outline.point[n].vertex;
    if (v.kind == Kind::crossing && v.sheet == sheet && v.place == edge) return n;
  }
  assert(false);
  return 0;
}

struct Polygon {
  int count = 0;
  std::array<CapVertex, 16> vertex{};
};

/// A chord between crossings of one sheet may be drawn by the present cell unless its type is the other cell's.
bool chord_is_free(const CapFace& face, const CapVertex& a, const CapVertex& b) {
  if (a.kind != Kind::crossing || b.kind != Kind::crossing || a.sheet != b.sheet) return true;
  const chord::FaceState state{.first_above = bit(face.above[a.sheet], 0), .joined_above = face.joined[a.sheet]};
  return !chord::allowed(face.face, state, a.place, b.place);
}

/// The vertex from which a fan is free of forbidden chords and of flat triangles: a middle, else a node.
int fan_centre(const Polygon& polygon) {
  int node = -1;
  for (int n = 0; n < polygon.count; ++n) {
    if (polygon.vertex[n].kind == Kind::middle) return n;
    if (polygon.vertex[n].kind == Kind::node && node < 0) node = n;
  }
  return node;
}

void add_triangle(const CapFace& face, CapVertex a, CapVertex b, CapVertex c, CapTriangles& out) {
  if (!cell::frame_is_counter_clockwise(face.face)) std::swap(b, c);
  out.triangle[out.count++] = {a, b, c};
}

/// Sub-polygon first, first + 1, ..., last of a polygon without nodes: the first apex whose chords are free.
bool fill_between(const CapFace& face, const Polygon& polygon, int first, int last, CapTriangles& out) {
  if (last - first < 2) return true;
  for (int apex = first + 1; apex < last; ++apex) {
    const CapVertex &a = polygon.vertex[first], &b = polygon.vertex[apex], &c = polygon.vertex[last];
    if (apex - first > 1 && !chord_is_free(face, a, b)) continue;
    if (last - apex > 1 && !chord_is_free(face, b, c)) continue;
    const int before = out.count;
    add_triangle(face, a, b, c, out);
    if (fill_between(face, polygon, first, apex, out) && fill_between(face, polygon, apex, last, out)) return true;
    out.count = before;
  }
  return false;
}

void fill_polygon(const CapFace& face, const Polygon& polygon, CapTriangles& out) {
  const int centre = fan_centre(polygon);
  if (centre < 0) {
    [[maybe_unused]] const bool filled = fill_between(face, polygon, 0, polygon.count - 1, out);
    assert(filled);
    return;
  }
  const auto at = [&](int n) { return polygon.vertex[(centre + n) % polygon.count]; };
  for (int n = 1; n + 1 < polygon.count; ++n) add_triangle(face, at(0), at(n), at(n + 1), out);
}

/// The polygon that starts where the body begins at outline point `start`; marks the points it uses.
Polygon trace_polygon(const CapFace& face, const Outline& outline, int start, unsigned& used) {
  Polygon polygon;
  int at = start;
  do {
    const OutlinePoint& point = outline.point[at];
    polygon.vertex[polygon.count++] = point.vertex;
    used |= 1u << at;
    if (point.leaves) {
      at = find_crossing(outline, point.vertex.sheet, segment_end(face, point.vertex.sheet, point.vertex.place));
    } else {
      at = (at + 1) % outline.count;
    }
  } while (at != start && polygon.count < outline.count);
  return polygon;
}

}  // namespace

CapTriangles cap_face(const CapFace& face) {
  CapTriangles triangles;
  const Outline outline = trace_outline(face);
  unsigned used = 0;
  bool has_crossing = false;
  for (int n = 0; n < outline.count; ++n) {
    has_crossing = has_crossing || outline.point[n].enters || outline.point[n].leaves;
    if (!outline.point[n].enters || ((used >> n) & 1)) continue;
    fill_polygon(face, trace_polygon(face, outline, n, used), triangles);
  }
  if (!has_crossing && outline.count > 0) fill_polygon(face, trace_polygon(face, outline, 0, used), triangles);
  return triangles;
}

}  // namespace geosis
