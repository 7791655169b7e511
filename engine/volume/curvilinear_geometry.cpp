#include "engine/volume/curvilinear_geometry.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "engine/base/parallel.h"

namespace geosis {
namespace {

/// The node below a coordinate whose cell reaches to it, and the way from there.
struct Place {
  std::int32_t node;
  double rest;
};
Place place_of(double coordinate, std::int32_t nodes) {
  const auto below = static_cast<std::int32_t>(std::clamp(std::floor(coordinate), 0.0, nodes - 2.0));
  return {below, coordinate - below};
}

}  // namespace

Result<CurvilinearGeometry> CurvilinearGeometry::from_nodes(GridShape shape, std::span<const Vec3d> nodes) {
  auto offsets = NodeOffsets::begin(shape);
  if (!offsets) return std::move(offsets).error();
  const auto kept = std::make_shared<std::vector<Vec3f>>();
  kept->reserve(nodes.size());
  if (auto added = offsets->add(nodes, *kept); !added) return std::move(added).error();
  if (auto whole = offsets->end(); !whole) return std::move(whole).error();
  const auto report = look_at_cells(shape, *kept, default_threads());
  if (!report) return report.error();
  return CurvilinearGeometry(shape, offsets->origin(), *kept, kept, *report);
}

Result<CurvilinearGeometry> CurvilinearGeometry::from_pillars(GridShape shape, std::span<const Pillar> pillars,
                                                              std::span<const double> depths) {
  const auto samples = static_cast<std::size_t>(shape.samples);
  if (pillars.size() * samples != depths.size()) {
    return bad_positions(std::to_string(pillars.size()) + " pillars and " + std::to_string(depths.size()) + " depths");
  }
  std::vector<Vec3d> nodes;
  nodes.reserve(depths.size());
  for (std::size_t trace = 0; trace < pillars.size(); ++trace) {
    if (auto sound = check_pillar(shape, trace, pillars[trace]); !sound) return std::move(sound).error();
    for (const double depth : depths.subspan(trace * samples, samples)) {
      nodes.push_back(point_on(pillars[trace], depth));
    }
  }
  return from_nodes(shape, nodes);
}

Vec3d CurvilinearGeometry::node(std::int32_t i, std::int32_t j, std::int32_t k) const {
  return to_double(nodes_[(static_cast<std::size_t>(i) * shape_.crosslines + j) * shape_.samples + k]);
}

Vec3d CurvilinearGeometry::map(Vec3d index) const {
  const Place i = place_of(index.x, shape_.inlines), j = place_of(index.y, shape_.crosslines),
              k = place_of(index.z, shape_.samples);
  Vec3d sum = origin_;
  for (int corner = 0; corner < 8; ++corner) {
    const int a = corner >> 2, b = corner >> 1 & 1, c = corner & 1;
    const double weight =
        (a != 0 ? i.rest : 1 - i.rest) * (b != 0 ? j.rest : 1 - j.rest) * (c != 0 ? k.rest : 1 - k.rest);
    if (weight != 0) sum = sum + node(i.node + a, j.node + b, k.node + c) * weight;
  }
  return sum;
}

}  // namespace geosis
