#include "engine/isosurface/brick_mesher.h"

#include <bit>
#include <cmath>

#include "engine/isosurface/body_sheets.h"
#include "engine/isosurface/cap_face.h"
#include "engine/isosurface/cell.h"
#include "engine/isosurface/cell_presence.h"
#include "engine/isosurface/contacts.h"
#include "engine/isosurface/mc33_tables.h"
#include "engine/isosurface/row_masks.h"
#include "engine/volume/brick_layout.h"

namespace geosis {
namespace {

constexpr int kSide = kBrickSamples;
constexpr int kPlane = kSide * kSide;
/// What can lie on an edge: the crossing of either sheet, or the middle of a contact edge.
constexpr int kKinds = 3, kMiddle = 2;
/// Set on a vertex number when the next number is a second copy of the vertex, for the cells beyond a contact.
constexpr std::int32_t kHasCopy = 1 << 30;

/// Vertex numbers of the edges along one axis that start in one plane of nodes. Only places whose vertex exists are
/// set.
using EdgeNumbers = std::array<std::array<std::int32_t, kPlane>, kKinds>;

struct PlaneNumbers {
  EdgeNumbers along_j, along_k;
  std::array<std::int32_t, kPlane> node;
};

/// Nodes of the brick that lie in the region, and the planes it shares with others.
struct LocalBox {
  std::array<int, 3> first{}, last{};
  std::array<bool, 3> has_previous{}, has_next{};  ///< another brick of the region begins or goes on here
};

LocalBox clip(const BrickView& view, const GridBox& region) {
  LocalBox box;
  for (int axis = 0; axis < 3; ++axis) {
    const int origin = view.first[axis];
    box.first[axis] = std::max(region.first[axis] - origin, 0);
    box.last[axis] = std::min(region.last[axis] - origin, view.extent[axis] - 1);
    box.has_previous[axis] = region.first[axis] < origin;
    box.has_next[axis] = region.last[axis] > origin + view.extent[axis] - 1;
  }
  return box;
}

/// Bits first .. last of a row.
std::uint64_t bits_between(int first, int last) {
  if (first > last) return 0;
  return (~std::uint64_t{0} >> (63 - last)) & (~std::uint64_t{0} << first);
}

/// Calls visit(n) for every bit set.
template <class Visit>
void each_bit(std::uint64_t bits, Visit&& visit) {
  for (; bits != 0; bits &= bits - 1) visit(std::countr_zero(bits));
}

}  // namespace

class BrickMesher::Work {
 public:
  Work(const BrickedVolume& volume, IsoRange range, const ExtractOptions& options)
      : volume_(volume),
        layout_(volume.shape()),
        range_(range),
        options_(options),
        sheets_(sheets_of(range, options.mode)),
        masks_(kPlane),
        planes_(std::make_unique<std::array<PlaneNumbers, 2>>()),
        between_(std::make_unique<EdgeNumbers>()) {}

  bool is_active(std::size_t brick) const;
  Result<BrickMesh> mesh(std::size_t brick);

 private:
  // Masks of the row at (a, b): bit c for node (a, b, c).
  const RowMasks& row(int a, int b) const { return masks_[static_cast<std::size_t>(a * kSide + b)]; }
  std::uint64_t above(int sheet, int a, int b) const {
    const RowMasks& m = row(a, b);
    switch (sheets_.sheet[sheet].kind) {
      case Sheet::Kind::low_end:
        return m.at_least;
      case Sheet::Kind::high_end:
        return m.greater;
      case Sheet::Kind::product:
        return m.at_least & ~m.greater;
    }
    return 0;
  }
  std::uint64_t inside(int a, int b) const { return row(a, b).at_least & ~row(a, b).greater; }
  bool is_inside(int a, int b, int c) const { return (inside(a, b) >> c) & 1; }
  float sample(int a, int b, int c) const {
    return view_.samples[(static_cast<std::size_t>(a) * view_.extent.crosslines + b) * view_.extent.samples + c];
  }

  Result<void> load(std::size_t brick);
  // Vertices.
  void number_plane(int a);
  void number_between(int a);
  void number_nodes(int a, int b);
  void number_edges(EdgeNumbers& numbers, int axis, int a, int b, std::uint64_t edges);
  void number_edge(EdgeNumbers& numbers, int axis, int a, int b, int c, unsigned crossed);
  std::int32_t add_vertex(int axis, int a, int b, int c, int step, bool has_copy);
  std::int32_t append_vertex(int axis, int a, int b, int c, Vec3f position);
  std::uint64_t crossed(int sheet, int axis, int a, int b) const;
  // Triangles.
  void fill_cells(int a, int b);
  void fill_cell(int sheet, int a, int b, int c);
  const Mc33Patch& patch_of(int sheet, std::uint8_t above, int a, int b, int c) const;
  std::int32_t vertex_on_edge(int kind, int edge, int a, int b, int c) const;
  std::int32_t vertex_on_node(int corner, int normal, int a, int b, int c) const;
  void add_triangle(std::int32_t p, std::int32_t q, std::int32_t r, bool turned);
  // Cap.
  void cap_cells(int a, int b);
  void cap_cell(int face, int a, int b, int c);
  CapFace cap_face_of(int face, int a, int b, int c) const;
  std::uint8_t corners_above(int sheet, int a, int b, int c) const;
  std::array<float, 8> cell_samples(int a, int b, int c) const;

  PlaneNumbers& plane(int a) { return (*planes_)[a & 1]; }
  const PlaneNumbers& plane(int a) const { return (*planes_)[a & 1]; }

  const BrickedVolume& volume_;
  const BrickLayout layout_;
  const IsoRange range_;
  const ExtractOptions& options_;
  const BodySheets sheets_;

  BrickView view_;
  LocalBox box_;
  CellPresence presence_;
  std::vector<RowMasks> masks_;
  std::unique_ptr<std::array<PlaneNumbers, 2>> planes_;  ///< nodes' planes a and a + 1
  std::unique_ptr<EdgeNumbers> between_;                 ///< edges from plane a to a + 1
  BrickMesh mesh_;
};

bool BrickMesher::Work::is_active(std::size_t brick) const {
  const BrickSummary summary = volume_.summary(brick);
  if (summary.all_missing) return false;
  const GridIndex place = layout_.place(brick), first = layout_.first_node(place);
  const GridShape extent = layout_.extent(place);
  bool at_border = false;
  for (int axis = 0; axis < 3; ++axis) {
    const int last = first[axis] + extent[axis] - 1;
    if (options_.region.first[axis] >= last || options_.region.last[axis] <= first[axis]) return false;  // no cell
    at_border = at_border || options_.region.first[axis] >= first[axis] || options_.region.last[axis] <= last;
  }
  const auto [min, max] = summary.range;
  if ((min < range_.low && max >= range_.low) || (min <= range_.high && max > range_.high)) return true;
  const bool has_inside = max >= range_.low && min <= range_.high;
  return options_.cap && has_inside && (at_border || misses_nearby(volume_, place));
}

Result<void> BrickMesher::Work::load(std::size_t brick) {
  auto view = volume_.brick(brick);
  if (!view) return std::move(view).error();
  view_ = *view;
  box_ = clip(view_, options_.region);
  mesh_ = {};
  for (int a = 0; a < view_.extent.inlines; ++a) {
    const std::size_t rows = static_cast<std::size_t>(view_.extent.crosslines),
                      length = static_cast<std::size_t>(view_.extent.samples);
    classify_rows(view_.samples + static_cast<std::size_t>(a) * rows * length, rows, length, range_.low, range_.high,
                  &masks_[static_cast<std::size_t>(a * kSide)]);
  }
  return presence_.load(volume_, layout_.place(brick), options_.region);
}

Result<BrickMesh> BrickMesher::Work::mesh(std::size_t brick) {
  if (auto loaded = load(brick); !loaded) return std::move(loaded).error();
  number_plane(box_.first[0]);
  for (int a = box_.first[0]; a < box_.last[0]; ++a) {
    number_between(a);
    number_plane(a + 1);
    for (int b = box_.first[1]; b < box_.last[1]; ++b) {
      fill_cells(a, b);
      if (options_.cap && !presence_.is_complete()) cap_cells(a, b);
    }
  }
  return std::move(mesh_);
}

// ---- vertices

/// Edges along `axis` that start in row (a, b) and are crossed by the sheet, as bits of their lower nodes.
std::uint64_t BrickMesher::Work::crossed(int sheet, int axis, int a, int b) const {
  const std::uint64_t here = above(sheet, a, b);
  if (axis == 2) return (here ^ (here >> 1)) & bits_between(box_.first[2], box_.last[2] - 1);
  return (here ^ (axis == 0 ? above(sheet, a + 1, b) : above(sheet, a, b + 1))) &
         bits_between(box_.first[2], box_.last[2]);
}

void BrickMesher::Work::number_plane(int a) {
  for (int b = box_.first[1]; b <= box_.last[1]; ++b) {
    if (b < box_.last[1]) number_edges(plane(a).along_j, 1, a, b, bits_between(box_.first[2], box_.last[2]));
    number_edges(plane(a).along_k, 2, a, b, bits_between(box_.first[2], box_.last[2] - 1));
    if (options_.cap && !presence_.is_complete()) number_nodes(a, b);
  }
}

void BrickMesher::Work::number_between(int a) {
  for (int b = box_.first[1]; b <= box_.last[1]; ++b) {
    number_edges(*between_, 0, a, b, bits_between(box_.first[2], box_.last[2]));
  }
}

void BrickMesher::Work::number_edges(EdgeNumbers& numbers, int axis, int a, int b, std::uint64_t edges) {
  std::array<std::uint64_t, 2> by_sheet{};
  for (int sheet = 0; sheet < sheets_.count; ++sheet) by_sheet[sheet] = crossed(sheet, axis, a, b);
  std::uint64_t wanted = by_sheet[0] | by_sheet[1];
  if (options_.cap && !presence_.is_complete()) {  // contact edges may lie wholly inside the body
    const std::uint64_t other = axis == 0 ? inside(a + 1, b) : axis == 1 ? inside(a, b + 1) : inside(a, b) >> 1;
    wanted |= inside(a, b) & other;
  }
  each_bit(wanted & edges, [&](int c) {
    number_edge(numbers, axis, a, b, c,
                static_cast<unsigned>((by_sheet[0] >> c) & 1) | static_cast<unsigned>((by_sheet[1] >> c) & 1) << 1);
  });
}

/// crossed   bit s: sheet s crosses the edge; 0: both ends are inside the body.
void BrickMesher::Work::number_edge(EdgeNumbers& numbers, int axis, int a, int b, int c, unsigned crossed) {
  bool is_contact = false;
  if (!presence_.is_complete()) {
    const unsigned cells = presence_.around_edge(axis, a, b, c);
    if (cells == 0) return;
    is_contact = contact::is_edge_contact(cells);
  }
  const auto at = static_cast<std::size_t>(b * kSide + c);
  if (crossed == 0) {
    if (is_contact) numbers[kMiddle][at] = add_vertex(axis, a, b, c, kLatticeStepsPerVoxel / 2, true);
    return;
  }
  const float f0 = sample(a, b, c), f1 = sample(a + (axis == 0), b + (axis == 1), c + (axis == 2));
  std::array<int, 2> step{};
  for (int sheet = 0; sheet < sheets_.count; ++sheet) {
    if ((crossed >> sheet) & 1) step[sheet] = sheets_.sheet[sheet].crossing_step(f0, f1);
  }
  if (crossed == 3) f0 < f1 ? separate_steps(step[0], step[1]) : separate_steps(step[1], step[0]);
  for (int sheet = 0; sheet < sheets_.count; ++sheet) {
    if ((crossed >> sheet) & 1) numbers[sheet][at] = add_vertex(axis, a, b, c, step[sheet], is_contact);
  }
}

/// The vertex `step` lattice steps along the edge, once or twice; its number, marked when there are two.
std::int32_t BrickMesher::Work::add_vertex(int axis, int a, int b, int c, int step, bool has_copy) {
  Vec3f position{static_cast<float>(view_.first.i + a), static_cast<float>(view_.first.j + b),
                 static_cast<float>(view_.first.k + c)};
  position[axis] += static_cast<float>(step) * kLatticeStep;
  const std::int32_t number = append_vertex(axis, a, b, c, position);
  if (has_copy) append_vertex(axis, a, b, c, position);
  return has_copy ? number | kHasCopy : number;
}

/// axis   of the edge that the vertex lies inside of; -1 for a vertex on a node.
std::int32_t BrickMesher::Work::append_vertex(int axis, int a, int b, int c, Vec3f position) {
  const auto number = static_cast<std::int32_t>(mesh_.positions.size());
  mesh_.positions.push_back(position);
  const std::array<int, 3> at{a, b, c};
  for (int normal = 0; normal < 3; ++normal) {
    if (normal == axis) continue;
    if (at[normal] == 0 && box_.has_previous[normal]) mesh_.lower_layer[normal].push_back(number);
    if (at[normal] == box_.last[normal] && box_.has_next[normal]) mesh_.upper_layer[normal].push_back(number);
  }
  return number;
}

void BrickMesher::Work::number_nodes(int a, int b) {
  each_bit(inside(a, b) & bits_between(box_.first[2], box_.last[2]), [&](int c) {
    const unsigned cells = presence_.around_node(a, b, c);
    const int copies = contact::node_copies(cells).count;
    const Vec3f position{static_cast<float>(view_.first.i + a), static_cast<float>(view_.first.j + b),
                         static_cast<float>(view_.first.k + c)};
    for (int n = 0; n < copies; ++n) {
      const std::int32_t number = append_vertex(-1, a, b, c, position);
      if (n == 0) plane(a).node[static_cast<std::size_t>(b * kSide + c)] = number;
    }
  });
}

// ---- triangles

void BrickMesher::Work::fill_cells(int a, int b) {
  const std::uint64_t cells = presence_.row(a, b) & bits_between(box_.first[2], box_.last[2] - 1);
  for (int sheet = 0; sheet < sheets_.count; ++sheet) {
    const std::uint64_t rows[4] = {above(sheet, a, b), above(sheet, a, b + 1), above(sheet, a + 1, b),
                                   above(sheet, a + 1, b + 1)};
    const std::uint64_t any = rows[0] | rows[1] | rows[2] | rows[3], all = rows[0] & rows[1] & rows[2] & rows[3];
    each_bit((any | any >> 1) & ~(all & all >> 1) & cells, [&](int c) { fill_cell(sheet, a, b, c); });
  }
}

std::uint8_t BrickMesher::Work::corners_above(int sheet, int a, int b, int c) const {
  const auto two = [&](int i, int j) { return static_cast<unsigned>(above(sheet, a + i, b + j) >> c) & 3u; };
  return static_cast<std::uint8_t>(two(0, 0) | two(0, 1) << 2 | two(1, 0) << 4 | two(1, 1) << 6);
}

std::array<float, 8> BrickMesher::Work::cell_samples(int a, int b, int c) const {
  std::array<float, 8> samples{};
  for (int corner = 0; corner < 8; ++corner) {
    samples[corner] = sample(a + (corner >> 2), b + ((corner >> 1) & 1), c + (corner & 1));
  }
  return samples;
}

void BrickMesher::Work::fill_cell(int sheet, int a, int b, int c) {
  const Mc33Patch& patch = patch_of(sheet, corners_above(sheet, a, b, c), a, b, c);
  const bool turned = !sheets_.sheet[sheet].body_is_above();  // the table's triangles look below the level
  for (int n = 0; n < patch.count; ++n) {
    const std::uint8_t* edges = kMc33Corners + patch.first + 3 * n;
    add_triangle(vertex_on_edge(sheet, edges[0], a, b, c), vertex_on_edge(sheet, edges[1], a, b, c),
                 vertex_on_edge(sheet, edges[2], a, b, c), turned);
  }
}

const Mc33Patch& BrickMesher::Work::patch_of(int sheet, std::uint8_t above, int a, int b, int c) const {
  const Mc33Mask& mask = kMc33Masks[above];
  const Mc33State* state = kMc33States + mask.first_state;
  const bool unambiguous = mask.ambiguous_faces == 0;
  if (unambiguous && state->tunnel_above == kNoTunnel && state->tunnel_below == kNoTunnel) return state->patch;

  const CellValues values = sheets_.sheet[sheet].cell_values(cell_samples(a, b, c));
  if (!unambiguous) state += pack_faces(joined_faces(values, above, mask.ambiguous_faces), mask.ambiguous_faces);
  if (state->tunnel_above == kNoTunnel && state->tunnel_below == kNoTunnel) return state->patch;
  const InteriorJoint joint = interior_joint(values, above);
  if (!joint.joined || state->region[joint.first] == state->region[joint.second]) return state->patch;
  const std::int16_t tunnel = joint.above ? state->tunnel_above : state->tunnel_below;
  return tunnel == kNoTunnel ? state->patch : kMc33Tunnels[tunnel];
}

std::int32_t BrickMesher::Work::vertex_on_edge(int kind, int edge, int a, int b, int c) const {
  const int start = cell::edge_start(edge);
  const int i = a + (start >> 2), j = b + ((start >> 1) & 1), k = c + (start & 1);
  const auto at = static_cast<std::size_t>(j * kSide + k);
  const int axis = cell::edge_axis(edge);
  const std::int32_t number = axis == 0   ? (*between_)[kind][at]
                              : axis == 1 ? plane(i).along_j[kind][at]
                                          : plane(i).along_k[kind][at];
  if ((number & kHasCopy) == 0) return number;
  return (number & ~kHasCopy) + contact::edge_copy(~edge & 3);  // the cell's place around the edge
}

void BrickMesher::Work::add_triangle(std::int32_t p, std::int32_t q, std::int32_t r, bool turned) {
  if (turned != options_.mirrored) std::swap(q, r);
  mesh_.triangles.push_back({p, q, r});
}

// ---- cap

void BrickMesher::Work::cap_cells(int a, int b) {
  const std::uint64_t cells = presence_.row(a, b);
  const std::uint64_t own = cells & bits_between(box_.first[2], box_.last[2] - 1);
  if (own == 0) return;
  const std::array<std::uint64_t, cell::kFaces> neighbours = {presence_.row(a - 1, b),
                                                              presence_.row(a + 1, b),
                                                              presence_.row(a, b - 1),
                                                              presence_.row(a, b + 1),
                                                              cells << 1 | presence_.before_row(a, b),
                                                              cells >> 1};
  for (int face = 0; face < cell::kFaces; ++face) {
    each_bit(own & ~neighbours[face], [&](int c) { cap_cell(face, a, b, c); });
  }
}

CapFace BrickMesher::Work::cap_face_of(int face, int a, int b, int c) const {
  CapFace cap{.face = face, .sheets = sheets_.count};
  for (int m = 0; m < 4; ++m) {
    const int corner = cell::face_corner(face, m);
    const int i = a + (corner >> 2), j = b + ((corner >> 1) & 1), k = c + (corner & 1);
    cap.inside = static_cast<std::uint8_t>(cap.inside | is_inside(i, j, k) << m);
    for (int sheet = 0; sheet < sheets_.count; ++sheet) {
      cap.above[sheet] = static_cast<std::uint8_t>(cap.above[sheet] | ((above(sheet, i, j) >> k) & 1) << m);
    }
    const int edge = cell::face_edge(face, m), start = cell::edge_start(edge);
    const unsigned cells =
        presence_.around_edge(cell::edge_axis(edge), a + (start >> 2), b + ((start >> 1) & 1), c + (start & 1));
    cap.contact_edges = static_cast<std::uint8_t>(cap.contact_edges | contact::is_edge_contact(cells) << m);
  }
  for (int sheet = 0; sheet < sheets_.count; ++sheet) {
    cap.body_is_above[sheet] = sheets_.sheet[sheet].body_is_above();
    if (const std::uint8_t corners = corners_above(sheet, a, b, c); cell::is_ambiguous(corners, face)) {
      cap.joined[sheet] = above_joined_on_face(sheets_.sheet[sheet].cell_values(cell_samples(a, b, c)), corners, face);
    }
  }
  return cap;
}

void BrickMesher::Work::cap_cell(int face, int a, int b, int c) {
  const CapTriangles cap = cap_face(cap_face_of(face, a, b, c));
  const auto number = [&](const CapVertex& v) {
    if (v.kind == CapVertex::Kind::node)
      return vertex_on_node(cell::face_corner(face, v.place), cell::face_axis(face), a, b, c);
    const int kind = v.kind == CapVertex::Kind::middle ? kMiddle : v.sheet;
    return vertex_on_edge(kind, cell::face_edge(face, v.place), a, b, c);
  };
  for (int n = 0; n < cap.count; ++n) {
    const auto& [p, q, r] = cap.triangle[n];
    add_triangle(number(p), number(q), number(r), false);
  }
}

/// The copy of a node's vertex that a border face with that normal uses, of the cell at (a, b, c).
std::int32_t BrickMesher::Work::vertex_on_node(int corner, int normal, int a, int b, int c) const {
  const int i = a + (corner >> 2), j = b + ((corner >> 1) & 1), k = c + (corner & 1);
  const int octant = 7 - corner;
  const int copy = contact::node_copies(presence_.around_node(i, j, k)).copy[octant][normal];
  return plane(i).node[static_cast<std::size_t>(j * kSide + k)] + copy;
}

// ---- the door

BrickMesher::BrickMesher(const BrickedVolume& volume, IsoRange range, const ExtractOptions& options)
    : work_(std::make_unique<Work>(volume, range, options)) {}
BrickMesher::~BrickMesher() = default;
bool BrickMesher::is_active(std::size_t brick) const {
  return work_->is_active(brick);
}
Result<BrickMesh> BrickMesher::mesh(std::size_t brick) {
  return work_->mesh(brick);
}

}  // namespace geosis
