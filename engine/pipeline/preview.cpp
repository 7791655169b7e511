#include "engine/pipeline/preview.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "engine/isosurface/estimate_triangles.h"
#include "engine/pipeline/output_space.h"
#include "engine/pipeline/stages.h"
#include "engine/volume/coarse_volume.h"

namespace geosis {
namespace {

constexpr std::int64_t kNodes = std::int64_t{3} << 19;  // 1.5 million
constexpr double kTriangles = 150'000;
constexpr int kFastest = 10;                // of the encoder
constexpr std::int32_t kTracesASample = 4;  // steps between traces for each step between samples

std::int64_t nodes_left(const GridBox& region, GridIndex step) {
  std::int64_t nodes = 1;
  for (int axis = 0; axis < 3; ++axis) nodes *= (region.last[axis] - region.first[axis]) / step[axis] + 1;
  return nodes;
}

/// Where the coarse nodes are.
AffineGeometry coarse_geometry(const GridGeometry& geometry, GridIndex first, GridIndex step) {
  const Vec3d at = {static_cast<double>(first.i), static_cast<double>(first.j), static_cast<double>(first.k)};
  const Vec3d origin = geometry.map(at);
  const auto axis_step = [&](int axis) {
    Vec3d next = at;
    next[axis] += step[axis];
    return geometry.map(next) - origin;
  };
  return {origin, axis_step(0), axis_step(1), axis_step(2)};
}

/// The same request of the coarse volume.
ReconstructOptions coarse_options(ReconstructOptions options, GridIndex first, GridIndex step, GridShape shape) {
  options.preview = false;
  options.region = std::nullopt;
  if (options.index_space) options.velocity = std::nullopt;
  options.index_space = false;  // the geometry says which space it is
  options.bodies.min_voxels /= static_cast<double>(step.i) * step.j * step.k;
  for (GridIndex& seed : options.bodies.seeds) {
    for (int axis = 0; axis < 3; ++axis) {
      const std::int32_t nearest = (seed[axis] - first[axis] + step[axis] / 2) / step[axis];
      seed[axis] = std::clamp(nearest, 0, shape[axis] - 1);
    }
  }
  return options;
}

}  // namespace

GridIndex preview_step(const GridBox& region, double triangles) {
  GridIndex step = {1, 1, 1};
  const auto is_fine = [&] { return nodes_left(region, step) > kNodes || triangles / thinning(step) > kTriangles; };
  for (std::int32_t traces = 2; is_fine() && traces < (1 << 28); traces += std::max(1, traces / 2)) {
    step = {traces, traces, std::max(1, traces / kTracesASample)};
  }
  return step;
}

double thinning(GridIndex step) {
  return std::pow(static_cast<double>(step.i) * step.j * step.k, 2.0 / 3);
}

ReconstructOptions preview_options(ReconstructOptions options) {
  options.preview = true;
  options.fill = {};
  options.grid = GridChoice::given;
  options.grid_id = std::nullopt;
  options.levels = by_ratio({1});
  options.strategy = Strategy::greedy;
  options.placement = Placement::optimal;
  options.seed = 0;
  options.attributes = {.reliability = false, .body = options.attributes.body};
  options.attribute_volume = std::nullopt;
  options.position_bits = std::nullopt;
  options.speed = kFastest;
  return options;
}

Result<Reconstruction> reconstruct_preview(const ReconstructInput& input, const ReconstructOptions& options,
                                           Progress& progress, StageTimings* timings, const LevelSink& on_level) {
  if (options.grid == GridChoice::curvilinear)
    return Error{ErrorCode::invalid_argument, "a preview of a curvilinear grid; previews lie on the given one"};
  const ExtractOptions extract = extract_options(options, input.samples.shape());
  const double triangles = estimate_triangles(input.samples, options.range, extract);
  const GridIndex step = preview_step(extract.region, triangles);
  const auto coarse = thin_out(input.samples, extract.region, step, options.threads, progress);
  if (!coarse) return coarse.error();
  const AffineGeometry index_space;
  const GridGeometry& space = options.index_space ? index_space : input.geometry;
  if (space.affine() == nullptr) return output_space(space, options).error();
  const AffineGeometry geometry = coarse_geometry(space, coarse->first, coarse->step);
  return reconstruct({.samples = *coarse->samples, .geometry = geometry, .has_lengths = input.has_lengths},
                     coarse_options(options, coarse->first, coarse->step, coarse->samples->shape()), progress, timings,
                     on_level);
}

}  // namespace geosis
