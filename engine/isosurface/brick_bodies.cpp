#include "engine/isosurface/brick_bodies.h"

#include <algorithm>

#include "engine/isosurface/cell.h"
#include "engine/isosurface/contacts.h"

namespace geosis {
namespace {

/// Vertices that no next brick owns, by the order they were made in.
std::vector<std::int32_t> own_vertices(const BrickMesh& mesh, const std::vector<std::int32_t>& piece) {
  std::vector<bool> is_shared(mesh.positions.size(), false);
  for (const auto& layer : mesh.upper_layer) {
    for (const std::int32_t v : layer) is_shared[v] = true;
  }
  std::vector<std::int32_t> own;
  own.reserve(mesh.positions.size());
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    if (!is_shared[v]) own.push_back(piece[v]);
  }
  return own;
}

std::array<std::int64_t, 3> lattice_steps(Vec3f p) {
  constexpr float kSteps = kLatticeStepsPerVoxel;
  return {static_cast<std::int64_t>(p.x * kSteps), static_cast<std::int64_t>(p.y * kSteps),
          static_cast<std::int64_t>(p.z * kSteps)};
}

/// Nodes that belong to the brick itself: those on the last layer belong to the next brick, if there is one.
LocalBox own_nodes(LocalBox box) {
  for (int axis = 0; axis < 3; ++axis) box.last[axis] -= box.has_next[axis];
  return box;
}

std::uint64_t bits_up_to(int last) {
  return last < 0 ? 0 : ~std::uint64_t{0} >> (63 - last);
}

/// Adds `count` samples that follow one another, four sums at a time in a fixed order.
void add_samples(const float* sample, int count, SampleTally& tally) {
  std::array<double, 4> sums{};
  int n = 0;
  for (; n + 4 <= count; n += 4) {
    for (int lane = 0; lane < 4; ++lane) sums[lane] += sample[n + lane];
  }
  for (; n < count; ++n) sums[0] += sample[n];
  tally.sum += (sums[0] + sums[1]) + (sums[2] + sums[3]);
  for (n = 0; n < count; ++n) {
    tally.min = std::min(tally.min, sample[n]);
    tally.max = std::max(tally.max, sample[n]);
  }
}

}  // namespace

void SampleTally::add(const SampleTally& other) {
  voxels += other.voxels;
  sum += other.sum;
  min = std::min(min, other.min);
  max = std::max(max, other.max);
}

BrickLabeller::BrickLabeller(const BrickField& field, const ExtractOptions& options, const LabelOptions& labels)
    : field_(field),
      capped_(options.cap),
      mirrored_(options.mirrored),
      amplitudes_(labels.amplitudes),
      labels_(labels),
      runs_(field) {}

BrickBodies BrickLabeller::label(const BrickMesh& mesh) {
  const auto vertices = static_cast<std::int32_t>(mesh.positions.size());
  runs_.find(vertices);
  sets_.reset(vertices + runs_.count());
  for (const auto& [p, q, r] : mesh.triangles) {
    sets_.unite(p, q);
    sets_.unite(q, r);
  }
  for (std::int32_t v = 0; v < vertices;) v += join_place(mesh, v);
  runs_.join(sets_);

  BrickBodies bodies;
  bodies.pieces = sets_.number_sets(piece_);
  bodies.of_own_vertex = own_vertices(mesh, piece_);
  bodies.samples.resize(static_cast<std::size_t>(bodies.pieces));
  const LocalBox& box = field_.box();
  const LocalBox own = own_nodes(box);
  for (int a = own.first[0]; a <= own.last[0]; ++a) {
    for (int b = own.first[1]; b <= own.last[1]; ++b) tally_row(a, b, bodies.samples);
  }
  if (capped_) bodies.six_volumes = lattice_volumes(mesh, piece_, bodies.pieces, mirrored_);
  for (int axis = 0; axis < 3; ++axis) {
    if (box.has_previous[axis]) bodies.layers[axis][0] = layer_of(mesh, axis, false);
    if (box.has_next[axis]) bodies.layers[axis][1] = layer_of(mesh, axis, true);
  }
  return bodies;
}

/// Joins the vertices at one place (they follow one another) to the nodes, or to each other. Returns how many.
std::int32_t BrickLabeller::join_place(const BrickMesh& mesh, std::int32_t vertex) {
  const Vec3f position = mesh.positions[vertex];
  std::array<int, 3> node{};
  int axis = -1, between = 0;
  for (int n = 0; n < 3; ++n) {
    const int whole = static_cast<int>(position[n]);
    if (position[n] != static_cast<float>(whole)) axis = n, ++between;
    node[n] = whole - field_.origin()[n];
  }
  if (between > 1) return 1;  // inside a cell: its triangles have joined it
  return axis < 0 ? join_node_copies(vertex, node[0], node[1], node[2])
                  : join_edge_vertices(vertex, axis, node[0], node[1], node[2]);
}

std::int32_t BrickLabeller::join_node_copies(std::int32_t vertex, int a, int b, int c) {
  const contact::NodeCopies& copies = contact::node_copies(field_.presence().around_node(a, b, c));
  if (copies.count == 1) {
    sets_.unite(vertex, runs_.element(a, b, c));
    return 1;
  }
  for (int octant = 0; octant < cell::kCorners; ++octant) {
    for (const std::int8_t copy : copies.copy[octant]) {
      if (copy >= 0) sets_.unite(vertex + copy, runs_.element(a, b, c, octant));
    }
  }
  return copies.count;
}

/// The crossings of one edge, or the vertices in the middle of a contact edge; each once, or one copy after the other.
std::int32_t BrickLabeller::join_edge_vertices(std::int32_t vertex, int axis, int a, int b, int c) {
  const int i = a + (axis == 0), j = b + (axis == 1), k = c + (axis == 2);
  const bool from_start = (field_.inside(a, b) >> c) & 1, from_end = (field_.inside(i, j) >> k) & 1;
  unsigned around = 1;
  if (!field_.presence().is_complete()) around = field_.presence().around_edge(axis, a, b, c);
  const int copies = contact::is_edge_contact(around) ? 2 : 1;
  for (int copy = 0; copy < copies; ++copy) {
    const int place = contact::edge_place(around, copy);
    if (from_start) {
      sets_.unite(vertex + copy, runs_.element(a, b, c, octant_at_start(axis, place)));
    } else if (from_end) {
      sets_.unite(vertex + copy, runs_.element(i, j, k, octant_at_end(axis, place)));
    } else {
      sets_.unite(vertex + copy, vertex + copies + copy);  // the two sheets, the body between them
    }
  }
  return from_start || from_end ? copies : 2 * copies;
}

/// The samples of a row's own nodes, run by run.
void BrickLabeller::tally_row(int a, int b, std::vector<SampleTally>& samples) const {
  const LocalBox own = own_nodes(field_.box());
  const std::uint64_t in_row = bits_up_to(own.last[2]), nodes = runs_.nodes(a, b) & in_row;
  if (nodes == 0) return;
  const std::uint64_t contacts = runs_.contacts(a, b), starts = runs_.starts(a, b), plain = nodes & ~contacts;
  const GridIndex origin = field_.origin();
  const std::uint64_t counts = counted({origin.i + a, origin.j + b, origin.k}, own.last[2] + 1);
  const auto tally = [&](int c, int count) {
    SampleTally& piece = samples[piece_[runs_.element(a, b, c)]];
    const auto add = [&](int first, int number) {
      piece.voxels += number;
      if (amplitudes_) add_samples(field_.samples_from(a, b, first), number, piece);
    };
    const std::uint64_t run = (~std::uint64_t{0} >> (64 - count)) << c;
    if ((run & ~counts) == 0) return add(c, count);
    each_bit(run & counts, [&](int n) { add(n, 1); });
  };
  each_bit(plain & starts, [&](int c) {
    const std::uint64_t past = (~plain | (starts & ~(std::uint64_t{1} << c))) >> c;
    tally(c, past == 0 ? 64 - c : std::countr_zero(past));
  });
  each_bit(nodes & contacts, [&](int c) { tally(c, 1); });
}

SharedLayer BrickLabeller::layer_of(const BrickMesh& mesh, int axis, bool upper) const {
  const LocalBox& box = field_.box();
  SharedLayer layer;
  const auto& vertices = upper ? mesh.upper_layer[axis] : mesh.lower_layer[axis];
  layer.of_vertex.reserve(vertices.size());
  for (const std::int32_t v : vertices) layer.of_vertex.push_back(piece_[v]);

  const int at = upper ? box.last[axis] : 0, rows = cell::first_axis(axis), along = cell::second_axis(axis);
  layer.rows.resize(kBrickSamples);
  for (int m = box.first[rows]; m <= box.last[rows]; ++m) {
    SharedLayer::Row& row = layer.rows[m];
    row.first = static_cast<std::int32_t>(layer.piece.size());
    std::array<int, 3> node{};
    node[axis] = at;
    node[rows] = m;
    if (axis != 2) {
      const std::uint64_t starts = runs_.starts(node[0], node[1]);
      each_bit(runs_.nodes(node[0], node[1]), [&](int c) {
        add_layer_node(layer, row, {node[0], node[1], c}, c, (starts >> c) & 1);
      });
      continue;
    }
    for (int b = box.first[along]; b <= box.last[along]; ++b) {
      if ((runs_.nodes(m, b) >> at) & 1) add_layer_node(layer, row, {m, b, at}, b, true);
    }
  }
  return layer;
}

/// n        the node's bit in the row.
/// may_start  false: the node continues the run before it.
void BrickLabeller::add_layer_node(SharedLayer& layer, SharedLayer::Row& row, GridIndex node, int n,
                                   bool may_start) const {
  const int a = node.i, b = node.j, c = node.k;
  const std::int32_t element = runs_.element(a, b, c);
  if ((runs_.contacts(a, b) >> c) & 1) {
    const int groups = contact::cell_groups(field_.presence().around_node(a, b, c)).count;
    for (int group = 0; group < groups; ++group) layer.of_contact.push_back(piece_[element + group]);
    return;
  }
  const bool follows = n > 0 && ((row.nodes >> (n - 1)) & 1);
  row.nodes |= std::uint64_t{1} << n;
  if (!may_start || (follows && layer.piece.back() == piece_[element])) return;
  row.starts |= std::uint64_t{1} << n;
  layer.piece.push_back(piece_[element]);
}

std::int32_t BrickLabeller::piece_of(GridIndex node) const {
  const GridIndex origin = field_.origin();
  const int a = node.i - origin.i, b = node.j - origin.j, c = node.k - origin.k;
  return (runs_.nodes(a, b) >> c) & 1 ? piece_[runs_.element(a, b, c)] : kNone;
}

/// As LabelOptions::counted, of the nodes from that one on.
std::uint64_t BrickLabeller::counted(GridIndex node, int count) const {
  return labels_.counted ? labels_.counted(node.i, node.j, node.k, count) : ~std::uint64_t{0};
}

Result<BrickBodies> BrickLabeller::label_whole(const BrickedVolume& volume, std::size_t brick,
                                               const GridBox& region) const {
  const BrickLayout layout(volume.shape());
  const GridIndex place = layout.place(brick);
  const LocalBox own = own_nodes(clip_to_region(layout.first_node(place), layout.extent(place), region));
  BrickBodies bodies;
  bodies.pieces = 1;
  bodies.is_whole = true;
  SampleTally tally;
  BrickView view;
  if (amplitudes_) {
    auto read = volume.brick(brick);
    if (!read) return std::move(read).error();
    view = *std::move(read);
  }
  const int count = own.last[2] - own.first[2] + 1;
  const std::uint64_t all = ~std::uint64_t{0} >> (64 - count);
  const GridIndex origin = layout.first_node(place);
  for (int a = own.first[0]; a <= own.last[0]; ++a) {
    for (int b = own.first[1]; b <= own.last[1]; ++b) {
      const std::uint64_t counts = counted({origin.i + a, origin.j + b, origin.k + own.first[2]}, count) & all;
      tally.voxels += std::popcount(counts);
      if (!amplitudes_) continue;
      const std::size_t row = static_cast<std::size_t>(a) * view.extent.crosslines + b;
      const float* samples = view.samples + row * view.extent.samples + own.first[2];
      if (counts == all) {
        add_samples(samples, count, tally);
      } else {
        each_bit(counts, [&](int n) { add_samples(samples + n, 1, tally); });
      }
    }
  }
  bodies.samples = {tally};
  if (capped_) bodies.six_volumes = {0};
  return bodies;
}

std::vector<std::uint64_t> lattice_volumes(const BrickMesh& mesh, std::span<const std::int32_t> of_vertex,
                                           std::int32_t pieces, bool mirrored) {
  std::vector<std::uint64_t> volumes(static_cast<std::size_t>(pieces), 0);
  for (const auto& [p, q, r] : mesh.triangles) {
    const auto a = lattice_steps(mesh.positions[p]), b = lattice_steps(mesh.positions[q]),
               c = lattice_steps(mesh.positions[r]);
    const std::int64_t twice_area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    volumes[of_vertex[p]] += static_cast<std::uint64_t>((a[2] + b[2] + c[2]) * twice_area);
  }
  if (mirrored) {
    for (std::uint64_t& volume : volumes) volume = -volume;
  }
  return volumes;
}

}  // namespace geosis
