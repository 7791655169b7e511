#include "engine/isosurface/labelled_surface.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <numeric>

#include "engine/base/parallel.h"
#include "engine/isosurface/brick_bodies.h"
#include "engine/isosurface/brick_mesher.h"
#include "engine/isosurface/brick_sweep.h"
#include "engine/isosurface/cell_presence.h"
#include "engine/isosurface/join_bodies.h"
#include "engine/isosurface/weld.h"
#include "engine/volume/brick_layout.h"

namespace geosis {
namespace {

/// A seed in its brick; the piece is filled in when the brick is labelled.
struct Seed {
  std::size_t number = 0;
  GridIndex node;
  std::int32_t piece = BrickLabeller::kNone;
};

/// What the bricks give: parts[n] and seeds[n] belong to bricks[n], meshes only to the first ones.
struct Sweep {
  std::vector<std::size_t> bricks;
  std::vector<BrickMesh> meshes;
  std::vector<BrickBodies> parts;
  std::vector<std::vector<Seed>> seeds;
};

/// The brick that counts the node as its own.
std::size_t owner_of(GridIndex node, const BrickLayout& layout, const GridBox& region) {
  GridIndex place;
  for (int axis = 0; axis < 3; ++axis) {
    place[axis] = (node[axis] == region.last[axis] ? node[axis] - 1 : node[axis]) / kBrickCells;
  }
  return layout.number(place);
}

bool contains(const GridBox& box, GridIndex node) {
  bool inside = true;
  for (int axis = 0; axis < 3; ++axis) {
    inside = inside && node[axis] >= box.first[axis] && node[axis] <= box.last[axis];
  }
  return inside;
}

void place_seeds(const std::vector<GridIndex>& nodes, const BrickLayout& layout, const GridBox& region, Sweep& sweep) {
  sweep.seeds.resize(sweep.bricks.size());
  if (nodes.empty()) return;
  constexpr std::size_t kAbsent = std::numeric_limits<std::size_t>::max();
  std::vector<std::size_t> slot(layout.brick_count(), kAbsent);
  for (std::size_t n = 0; n < sweep.bricks.size(); ++n) slot[sweep.bricks[n]] = n;
  for (std::size_t number = 0; number < nodes.size(); ++number) {
    if (!contains(region, nodes[number])) continue;
    const std::size_t n = slot[owner_of(nodes[number], layout, region)];
    if (n != kAbsent) sweep.seeds[n].push_back({.number = number, .node = nodes[number]});
  }
}

/// Meshes and labels brick after brick of a sweep.
class LabelWorker {
 public:
  LabelWorker(const BrickedVolume& volume, IsoRange range, const ExtractOptions& options, const LabelOptions& labels,
              Sweep& sweep)
      : volume_(volume),
        options_(options),
        sweep_(sweep),
        mesher_(volume, range, options),
        labeller_(mesher_.field(), options, labels) {}
  LabelWorker(const LabelWorker&) = delete;
  LabelWorker& operator=(const LabelWorker&) = delete;

  Result<void> operator()(std::size_t n) {
    const bool is_quiet = n >= sweep_.meshes.size();
    return is_quiet && is_whole(sweep_.bricks[n]) ? label_whole(n) : mesh_and_label(n, is_quiet);
  }

 private:
  bool is_whole(std::size_t quiet_brick) const {
    return options_.cap || !misses_nearby(volume_, BrickLayout(volume_.shape()).place(quiet_brick));
  }

  Result<void> label_whole(std::size_t n) {
    auto whole = labeller_.label_whole(volume_, sweep_.bricks[n], options_.region);
    if (!whole) return std::move(whole).error();
    sweep_.parts[n] = std::move(whole).value();
    for (Seed& seed : sweep_.seeds[n]) seed.piece = 0;
    return {};
  }

  Result<void> mesh_and_label(std::size_t n, bool is_quiet) {
    auto mesh = mesher_.mesh(sweep_.bricks[n]);
    if (!mesh) return std::move(mesh).error();
    sweep_.parts[n] = labeller_.label(*mesh);
    for (Seed& seed : sweep_.seeds[n]) seed.piece = labeller_.piece_of(seed.node);
    if (!is_quiet) sweep_.meshes[n] = std::move(mesh).value();
    return {};
  }

  const BrickedVolume& volume_;
  const ExtractOptions& options_;
  Sweep& sweep_;
  BrickMesher mesher_;
  BrickLabeller labeller_;
};

/// Meshes and labels all bricks that hold some of the solid.
Result<Sweep> sweep_solid(const BrickedVolume& volume, IsoRange range, const ExtractOptions& options,
                          const LabelOptions& labels, Progress& progress) {
  Sweep sweep;
  sweep.bricks = active_bricks(volume, range, options);
  sweep.meshes.resize(sweep.bricks.size());
  const auto quiet = quiet_bricks(volume, range, options);
  sweep.bricks.insert(sweep.bricks.end(), quiet.begin(), quiet.end());
  sweep.parts.resize(sweep.bricks.size());
  place_seeds(labels.seeds, BrickLayout(volume.shape()), options.region, sweep);
  auto swept = sweep_bricks(sweep.bricks.size(), options.threads, progress,
                            [&] { return LabelWorker(volume, range, options, labels, sweep); });
  if (!swept) return std::move(swept).error();
  return sweep;
}

/// What the pieces of one body add up to.
struct BodyTotals {
  static constexpr std::int64_t kNoVertex = std::numeric_limits<std::int64_t>::max();

  SampleTally samples;
  std::uint64_t six_volumes = 0;
  std::int64_t lowest_vertex = kNoVertex;
};

std::vector<BodyTotals> add_up(const Sweep& sweep, const JoinedBodies& joined) {
  std::vector<BodyTotals> totals(static_cast<std::size_t>(joined.count));
  std::int64_t vertex = 0;
  for (std::size_t n = 0; n < sweep.parts.size(); ++n) {
    const BrickBodies& part = sweep.parts[n];
    const std::int32_t* body = joined.body.data() + joined.first_piece[n];
    for (std::int32_t piece = 0; piece < part.pieces; ++piece) {
      totals[body[piece]].samples.add(part.samples[piece]);
      if (!part.six_volumes.empty()) totals[body[piece]].six_volumes += part.six_volumes[piece];
    }
    for (const std::int32_t piece : part.of_own_vertex) {
      std::int64_t& lowest = totals[body[piece]].lowest_vertex;
      if (lowest == BodyTotals::kNoVertex) lowest = vertex;
      ++vertex;
    }
  }
  return totals;
}

double size_of(const BodyTotals& totals, bool capped) {
  constexpr double kSixCubes = 6.0 * kLatticeStepsPerVoxel * kLatticeStepsPerVoxel * kLatticeStepsPerVoxel;
  if (!capped) return static_cast<double>(totals.samples.voxels);
  return static_cast<double>(std::bit_cast<std::int64_t>(totals.six_volumes)) / kSixCubes;
}

/// The bodies in the order of their numbers.
std::vector<std::int32_t> order_bodies(const std::vector<BodyTotals>& totals, const std::vector<double>& sizes) {
  std::vector<std::int32_t> order(totals.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](std::int32_t a, std::int32_t b) {
    if (sizes[a] != sizes[b]) return sizes[a] > sizes[b];
    if (totals[a].lowest_vertex != totals[b].lowest_vertex) return totals[a].lowest_vertex < totals[b].lowest_vertex;
    return a < b;  // without vertices: as their pieces come
  });
  return order;
}

BodySamples samples_of(const SampleTally& tally, bool amplitudes) {
  BodySamples samples;
  samples.voxels = tally.voxels;
  if (amplitudes && tally.voxels > 0) {
    samples.amplitude = {.mean = tally.sum / static_cast<double>(tally.voxels), .min = tally.min, .max = tally.max};
  }
  return samples;
}

/// Labels of the welded vertices: each brick's own, one brick after the other.
std::vector<std::uint32_t> label_vertices(const Sweep& sweep, const JoinedBodies& joined,
                                          const std::vector<std::uint32_t>& number, int threads) {
  std::vector<std::size_t> first_vertex;
  std::size_t vertices = 0;
  for (const BrickBodies& part : sweep.parts) {
    first_vertex.push_back(vertices);
    vertices += part.of_own_vertex.size();
  }
  std::vector<std::uint32_t> body(vertices);
  parallel_for(sweep.parts.size(), threads, [&](std::size_t n) {
    std::uint32_t* out = body.data() + first_vertex[n];
    for (const std::int32_t piece : sweep.parts[n].of_own_vertex) {
      *out++ = number[joined.body[joined.first_piece[n] + piece]];
    }
  });
  return body;
}

LabelledSurface label_surface(const Sweep& sweep, const JoinedBodies& joined, const ExtractOptions& options,
                              const LabelOptions& labels) {
  const std::vector<BodyTotals> totals = add_up(sweep, joined);
  std::vector<double> sizes;
  sizes.reserve(totals.size());
  for (const BodyTotals& body : totals) sizes.push_back(size_of(body, options.cap));
  LabelledSurface surface;
  std::vector<std::uint32_t> number(totals.size());
  for (const std::int32_t body : order_bodies(totals, sizes)) {
    number[body] = static_cast<std::uint32_t>(surface.samples.size());
    surface.samples.push_back(samples_of(totals[body].samples, labels.amplitudes));
    surface.volume_voxels.push_back(sizes[body]);
  }
  surface.body = label_vertices(sweep, joined, number, options.threads);
  surface.seed_body.resize(labels.seeds.size());
  for (std::size_t n = 0; n < sweep.seeds.size(); ++n) {
    for (const Seed& seed : sweep.seeds[n]) {
      if (seed.piece == BrickLabeller::kNone) continue;
      surface.seed_body[seed.number] = number[joined.body[joined.first_piece[n] + seed.piece]];
    }
  }
  return surface;
}

}  // namespace

Result<LabelledSurface> extract_labelled_body(const BrickedVolume& volume, IsoRange range,
                                              const ExtractOptions& options, const LabelOptions& labels,
                                              Progress& progress) {
  if (auto checked = check_request(volume.shape(), range, options); !checked) return std::move(checked).error();
  const BrickLayout layout(volume.shape());
  auto sweep = sweep_solid(volume, range, options, labels, progress);
  if (!sweep) return std::move(sweep).error();
  const auto joined = join_bodies(layout, sweep->bricks, sweep->parts);
  if (!joined) return joined.error();
  LabelledSurface surface = label_surface(*sweep, *joined, options, labels);
  sweep->parts = {};
  sweep->bricks.resize(sweep->meshes.size());
  auto mesh = weld_bricks(layout, sweep->bricks, std::move(sweep->meshes), options.max_triangles, options.threads);
  if (!mesh) return std::move(mesh).error();
  surface.mesh = std::move(mesh).value();
  return surface;
}

}  // namespace geosis
