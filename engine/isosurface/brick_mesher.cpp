#include "engine/isosurface/brick_mesher.h"

#include <array>
#include <utility>

#include "engine/isosurface/cell.h"
#include "engine/isosurface/contacts.h"

namespace geosis {

BrickMesher::BrickMesher(const BrickedVolume& volume, IsoRange range, const ExtractOptions& options)
    : mirrored_(options.mirrored), field_(volume, range, options), vertices_(field_, mesh_) {}

Result<BrickMesh> BrickMesher::mesh(std::size_t brick) {
  mesh_ = {};
  if (auto loaded = field_.load(brick); !loaded) return std::move(loaded).error();
  const LocalBox& box = field_.box();
  vertices_.make_plane(box.first[0]);
  for (int a = box.first[0]; a < box.last[0]; ++a) {
    vertices_.make_between(a);
    vertices_.make_plane(a + 1);
    for (int b = box.first[1]; b < box.last[1]; ++b) {
      fill_cells(a, b);
      if (field_.needs_cap()) cap_cells(a, b);
    }
  }
  return std::move(mesh_);
}

/// The cells of a row that a sheet passes through: not all corners on one side.
void BrickMesher::fill_cells(int a, int b) {
  const std::uint64_t cells = field_.presence().row(a, b) & field_.cells_in_region();
  for (int sheet = 0; sheet < field_.sheets().count; ++sheet) {
    const std::uint64_t rows[4] = {field_.above(sheet, a, b), field_.above(sheet, a, b + 1),
                                   field_.above(sheet, a + 1, b), field_.above(sheet, a + 1, b + 1)};
    const std::uint64_t any = rows[0] | rows[1] | rows[2] | rows[3], all = rows[0] & rows[1] & rows[2] & rows[3];
    each_bit((any | any >> 1) & ~(all & all >> 1) & cells, [&](int c) { fill_cell(sheet, a, b, c); });
  }
}

void BrickMesher::fill_cell(int sheet, int a, int b, int c) {
  const Mc33Patch patch = patch_of(sheet, a, b, c);
  const bool turned = !field_.sheets().sheet[sheet].body_is_above();  // the table's triangles look below the level
  for (int n = 0; n < patch.count; ++n) {
    const std::uint8_t* edges = kMc33Corners + patch.first + 3 * n;
    const auto number = [&](int m) {
      return edges[m] == kInnerVertex ? inner_vertex_ : vertices_.on_edge(sheet, edges[m], a, b, c);
    };
    add_triangle(number(0), number(1), number(2), turned);
  }
}

/// Signs first; faces only where they are ambiguous; the interior only where a tunnel is possible.
Mc33Patch BrickMesher::patch_of(int sheet, int a, int b, int c) {
  const std::uint8_t above = field_.corners_above(sheet, a, b, c);
  const Mc33Mask& mask = kMc33Masks[above];
  const Mc33State* state = kMc33States + mask.first_state;
  const bool may_have_tunnel = state->tunnel_above != kNoTunnel || state->tunnel_below != kNoTunnel;
  if (mask.ambiguous_faces == 0 && !may_have_tunnel) return state->patch;

  const CellValues values = field_.cell_values(sheet, a, b, c);
  state += pack_faces(joined_faces(values, above, mask.ambiguous_faces), mask.ambiguous_faces);
  if (state->tunnel_above == kNoTunnel && state->tunnel_below == kNoTunnel) return state->patch;
  const InteriorJoint joint = interior_joint(values, above);
  if (!joint.joined || state->region[joint.first] == state->region[joint.second]) return state->patch;
  const std::int16_t tunnel = joint.above ? state->tunnel_above : state->tunnel_below;
  return tunnel == kNoTunnel ? state->patch : tunnel_patch(kMc33Tunnels[tunnel], sheet, a, b, c);
}

/// The first patch of the tunnel that does not cut itself where its vertices lie; the first of all when each does,
/// which takes crossings that are not those of the function that decided the cell (sampled mode). Makes the vertex
/// inside.
Mc33Patch BrickMesher::tunnel_patch(const Mc33Tunnel& tunnel, int sheet, int a, int b, int c) {
  const Mc33TunnelPatch* const first = kMc33TunnelPatches + tunnel.first;
  if (tunnel.count == 1) return first->patch;
  CellPoints points = crossings_of(sheet, a, b, c);
  for (int n = 0; n < tunnel.count; ++n) {
    const Mc33TunnelPatch& choice = first[n];
    if (choice.has_inner_vertex()) points[kInnerVertex] = inner_point(choice, points, sheet);
    if (patch_cuts_itself({kMc33Corners + choice.patch.first, 3u * choice.patch.count}, points)) continue;
    if (choice.has_inner_vertex()) inner_vertex_ = vertices_.add_inside(a, b, c, points[kInnerVertex]);
    return choice.patch;
  }
  return first->patch;
}

/// Where the sheet's vertices lie in a cell, in lattice steps from its corner 0.
CellPoints BrickMesher::crossings_of(int sheet, int a, int b, int c) const {
  const std::uint8_t above = field_.corners_above(sheet, a, b, c);
  const GridIndex origin = field_.origin();
  const std::array<int, 3> node = {origin.i + a, origin.j + b, origin.k + c};
  CellPoints points{};
  for (int edge = 0; edge < cell::kEdges; ++edge) {
    const bool is_crossed = ((above >> cell::edge_start(edge)) & 1) != ((above >> cell::edge_end(edge)) & 1);
    if (!is_crossed) continue;
    const Vec3f position = mesh_.positions[vertices_.on_edge(sheet, edge, a, b, c)];
    for (int axis = 0; axis < 3; ++axis) {
      points[edge][axis] =
          static_cast<std::int64_t>((static_cast<double>(position[axis]) - node[axis]) * kLatticeStepsPerVoxel);
    }
  }
  return points;
}

/// The faces of a row's cells behind which a cell is absent.
void BrickMesher::cap_cells(int a, int b) {
  const CellPresence& presence = field_.presence();
  const std::uint64_t cells = presence.row(a, b), own = cells & field_.cells_in_region();
  if (own == 0) return;
  const std::array<std::uint64_t, cell::kFaces> neighbours = {presence.row(a - 1, b),
                                                              presence.row(a + 1, b),
                                                              presence.row(a, b - 1),
                                                              presence.row(a, b + 1),
                                                              cells << 1 | presence.before_row(a, b),
                                                              cells >> 1};
  for (int face = 0; face < cell::kFaces; ++face) {
    each_bit(own & ~neighbours[face], [&](int c) { cap_cell(face, a, b, c); });
  }
}

void BrickMesher::cap_cell(int face, int a, int b, int c) {
  const CapTriangles cap = cap_face(cap_face_of(face, a, b, c));
  const auto number = [&](const CapVertex& v) {
    if (v.kind == CapVertex::Kind::node) {
      return vertices_.on_corner(cell::face_corner(face, v.place), cell::face_axis(face), a, b, c);
    }
    const int kind = v.kind == CapVertex::Kind::middle ? BrickVertices::kMiddle : v.sheet;
    return vertices_.on_edge(kind, cell::face_edge(face, v.place), a, b, c);
  };
  for (int n = 0; n < cap.count; ++n) {
    const auto& [p, q, r] = cap.triangle[n];
    add_triangle(number(p), number(q), number(r), false);
  }
}

CapFace BrickMesher::cap_face_of(int face, int a, int b, int c) const {
  CapFace cap{.face = face, .sheets = field_.sheets().count};
  const auto set = [](std::uint8_t& bits, int m, std::uint64_t bit) {
    bits = static_cast<std::uint8_t>(bits | (bit & 1) << m);
  };
  for (int m = 0; m < 4; ++m) {
    const int corner = cell::face_corner(face, m);
    const int i = a + (corner >> 2), j = b + ((corner >> 1) & 1), k = c + (corner & 1);
    set(cap.inside, m, field_.inside(i, j) >> k);
    for (int sheet = 0; sheet < cap.sheets; ++sheet) set(cap.above[sheet], m, field_.above(sheet, i, j) >> k);
    const int edge = cell::face_edge(face, m), start = cell::edge_start(edge);
    const unsigned around =
        field_.presence().around_edge(cell::edge_axis(edge), a + (start >> 2), b + ((start >> 1) & 1), c + (start & 1));
    set(cap.contact_edges, m, contact::is_edge_contact(around));
  }
  for (int sheet = 0; sheet < cap.sheets; ++sheet) {
    cap.body_is_above[sheet] = field_.sheets().sheet[sheet].body_is_above();
    const std::uint8_t corners = field_.corners_above(sheet, a, b, c);
    if (!cell::is_ambiguous(corners, face)) continue;
    cap.joined[sheet] = above_joined_on_face(field_.cell_values(sheet, a, b, c), corners, face);
  }
  return cap;
}

void BrickMesher::add_triangle(std::int32_t p, std::int32_t q, std::int32_t r, bool turned) {
  if (turned != mirrored_) std::swap(q, r);
  mesh_.triangles.push_back({p, q, r});
}

}  // namespace geosis
