#include "engine/isosurface/brick_vertices.h"

#include "engine/isosurface/cell.h"
#include "engine/isosurface/contacts.h"

namespace geosis {
namespace {

constexpr int kNoAxis = -1;
/// Set on a vertex number when the next number is a second copy of the vertex, for the cells beyond a contact.
constexpr std::int32_t kHasCopy = 1 << 30;

}  // namespace

BrickVertices::BrickVertices(const BrickField& field, BrickMesh& mesh)
    : field_(field),
      mesh_(mesh),
      planes_(std::make_unique<std::array<PlaneNumbers, 2>>()),
      between_(std::make_unique<EdgeNumbers>()) {}

void BrickVertices::make_plane(int a) {
  const LocalBox& box = field_.box();
  for (int b = box.first[1]; b <= box.last[1]; ++b) {
    if (b < box.last[1]) make_row(plane(a).along_j, 1, a, b);
    make_row(plane(a).along_k, 2, a, b);
    if (field_.needs_cap()) make_nodes(a, b);
  }
}

void BrickVertices::make_between(int a) {
  for (int b = field_.box().first[1]; b <= field_.box().last[1]; ++b) make_row(*between_, 0, a, b);
}

/// The vertices of all edges along `axis` that start in row (a, b).
void BrickVertices::make_row(EdgeNumbers& numbers, int axis, int a, int b) {
  std::array<std::uint64_t, 2> crossed{};
  for (int sheet = 0; sheet < field_.sheets().count; ++sheet) crossed[sheet] = field_.crossed(sheet, axis, a, b);
  std::uint64_t edges = crossed[0] | crossed[1];
  if (field_.needs_cap()) edges |= field_.covered(axis, a, b);
  each_bit(edges, [&](int c) {
    const auto sheets = static_cast<unsigned>((crossed[0] >> c & 1) | (crossed[1] >> c & 1) << 1);
    make_edge(numbers, axis, a, b, c, sheets);
  });
}

/// crossed   bit s: sheet s crosses the edge; 0: the edge lies wholly inside the body.
void BrickVertices::make_edge(EdgeNumbers& numbers, int axis, int a, int b, int c, unsigned crossed) {
  bool is_contact = false;
  if (!field_.presence().is_complete()) {
    const unsigned cells = field_.presence().around_edge(axis, a, b, c);
    if (cells == 0) return;
    is_contact = contact::is_edge_contact(cells);
  }
  if (crossed == 0) {
    if (is_contact) numbers[kMiddle][place(b, c)] = add_on_edge(axis, a, b, c, kLatticeStepsPerVoxel / 2, true);
    return;
  }
  const std::array<int, 2> step = crossing_steps(axis, a, b, c, crossed);
  for (int sheet = 0; sheet < 2; ++sheet) {
    if ((crossed >> sheet) & 1) numbers[sheet][place(b, c)] = add_on_edge(axis, a, b, c, step[sheet], is_contact);
  }
}

std::array<int, 2> BrickVertices::crossing_steps(int axis, int a, int b, int c, unsigned crossed) const {
  const float f0 = field_.sample(a, b, c), f1 = field_.sample(a + (axis == 0), b + (axis == 1), c + (axis == 2));
  std::array<int, 2> step{};
  for (int sheet = 0; sheet < 2; ++sheet) {
    if ((crossed >> sheet) & 1) step[sheet] = field_.sheets().sheet[sheet].crossing_step(f0, f1);
  }
  if (crossed == 3) f0 < f1 ? separate_steps(step[0], step[1]) : separate_steps(step[1], step[0]);
  return step;
}

void BrickVertices::make_nodes(int a, int b) {
  each_bit(field_.inside(a, b) & field_.nodes_in_region(), [&](int c) {
    const int copies = contact::node_copies(field_.presence().around_node(a, b, c)).count;
    for (int n = 0; n < copies; ++n) {
      const std::int32_t number = append(kNoAxis, a, b, c, 0);
      if (n == 0) plane(a).node[place(b, c)] = number;
    }
  });
}

/// The vertex `step` lattice steps along the edge, once or twice; its number, marked when there are two.
std::int32_t BrickVertices::add_on_edge(int axis, int a, int b, int c, int step, bool has_copy) {
  const std::int32_t number = append(axis, a, b, c, step);
  if (has_copy) append(axis, a, b, c, step);
  return has_copy ? number | kHasCopy : number;
}

/// axis   of the edge whose inside the vertex lies in; kNoAxis for a vertex on the node.
std::int32_t BrickVertices::append(int axis, int a, int b, int c, int step) {
  const auto number = static_cast<std::int32_t>(mesh_.positions.size());
  const std::array<int, 3> at{a, b, c};
  const LocalBox& box = field_.box();
  Vec3f position;
  for (int n = 0; n < 3; ++n) {
    position[n] = static_cast<float>(field_.origin()[n] + at[n]);
    if (n == axis) {
      position[n] += static_cast<float>(step) * kLatticeStep;
      continue;
    }
    if (at[n] == 0 && box.has_previous[n]) mesh_.lower_layer[n].push_back(number);
    if (at[n] == box.last[n] && box.has_next[n]) mesh_.upper_layer[n].push_back(number);
  }
  mesh_.positions.push_back(position);
  return number;
}

std::int32_t BrickVertices::add_inside(int a, int b, int c, const LatticePoint& steps) {
  const auto number = static_cast<std::int32_t>(mesh_.positions.size());
  const std::array<int, 3> at{a, b, c};
  Vec3f position;
  for (int n = 0; n < 3; ++n) {
    position[n] = static_cast<float>(field_.origin()[n] + at[n]) + static_cast<float>(steps[n]) * kLatticeStep;
  }
  mesh_.positions.push_back(position);
  return number;
}

std::int32_t BrickVertices::on_edge(int kind, int edge, int a, int b, int c) const {
  const int start = cell::edge_start(edge), axis = cell::edge_axis(edge);
  const int i = a + (start >> 2);
  const std::size_t at = place(b + ((start >> 1) & 1), c + (start & 1));
  const EdgeNumbers& numbers = axis == 0 ? *between_ : axis == 1 ? plane(i).along_j : plane(i).along_k;
  const std::int32_t number = numbers[kind][at];
  if ((number & kHasCopy) == 0) return number;
  return (number & ~kHasCopy) + contact::edge_copy(~edge & 3);  // the cell's place around the edge
}

std::int32_t BrickVertices::on_corner(int corner, int normal, int a, int b, int c) const {
  const int i = a + (corner >> 2), j = b + ((corner >> 1) & 1), k = c + (corner & 1);
  const int octant = 7 - corner;  // the cell's place around the node
  return plane(i).node[place(j, k)] + contact::node_copies(field_.presence().around_node(i, j, k)).copy[octant][normal];
}

}  // namespace geosis
