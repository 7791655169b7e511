#include "engine/volume/curvilinear_geometry.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>

namespace geosis {
namespace {

Error malformed(const std::string& what) {
  return {ErrorCode::malformed_input, "node positions: " + what};
}

std::string name_of(GridShape shape, std::size_t node) {
  const auto samples = static_cast<std::size_t>(shape.samples), crosslines = static_cast<std::size_t>(shape.crosslines);
  return "node [" + std::to_string(node / samples / crosslines) + "," + std::to_string(node / samples % crosslines) +
         "," + std::to_string(node % samples) + "]";
}

bool is_finite(Vec3d p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

Result<void> check_nodes(GridShape shape, std::span<const Vec3d> nodes) {
  if (std::min({shape.inlines, shape.crosslines, shape.samples}) < 2)
    return malformed("an axis has less than two nodes");
  if (nodes.size() != static_cast<std::size_t>(shape.count())) {
    return malformed(std::to_string(nodes.size()) + "; the volume has " + std::to_string(shape.count()) + " nodes");
  }
  const auto odd = std::find_if(nodes.begin(), nodes.end(), [](Vec3d p) { return !is_finite(p); });
  if (odd != nodes.end()) {
    return malformed(name_of(shape, static_cast<std::size_t>(odd - nodes.begin())) + " is not finite");
  }
  return {};
}

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

CurvilinearGeometry::CurvilinearGeometry(GridShape shape, std::span<const Vec3d> nodes)
    : shape_(shape), origin_(nodes.front()) {
  nodes_.reserve(nodes.size());
  for (const Vec3d& p : nodes) {
    const Vec3d q = p - origin_;
    nodes_.push_back({static_cast<float>(q.x), static_cast<float>(q.y), static_cast<float>(q.z)});
  }
}

Result<CurvilinearGeometry> CurvilinearGeometry::from_nodes(GridShape shape, std::span<const Vec3d> nodes) {
  if (auto sound = check_nodes(shape, nodes); !sound) return std::move(sound).error();
  CurvilinearGeometry geometry(shape, nodes);
  if (auto found = geometry.find_handedness(); !found) return std::move(found).error();
  return geometry;
}

Result<CurvilinearGeometry> CurvilinearGeometry::from_pillars(GridShape shape, std::span<const Pillar> pillars,
                                                              std::span<const double> depths) {
  const auto samples = static_cast<std::size_t>(shape.samples);
  if (pillars.size() * samples != depths.size()) {
    return malformed(std::to_string(pillars.size()) + " pillars and " + std::to_string(depths.size()) + " depths");
  }
  std::vector<Vec3d> nodes;
  nodes.reserve(depths.size());
  for (std::size_t n = 0; n < depths.size(); ++n) {
    const Pillar& pillar = pillars[n / samples];
    const double height = pillar.bottom.z - pillar.top.z;
    if (height == 0) return malformed("pillar " + std::to_string(n / samples) + " has both ends at one depth");
    nodes.push_back(pillar.top + (pillar.bottom - pillar.top) * ((depths[n] - pillar.top.z) / height));
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

/// The determinant of the three edges that leave a corner of the cell at (i, j, k), seen along the axes.
double CurvilinearGeometry::turn_of(std::int32_t i, std::int32_t j, std::int32_t k, int corner) const {
  const int a = corner >> 2, b = corner >> 1 & 1, c = corner & 1;
  const Vec3d along_i = node(i + 1, j + b, k + c) - node(i, j + b, k + c);
  const Vec3d along_j = node(i + a, j + 1, k + c) - node(i + a, j, k + c);
  const Vec3d along_k = node(i + a, j + b, k + 1) - node(i + a, j + b, k);
  return dot(along_i, cross(along_j, along_k));
}

/// A cell is folded when a corner of it turns the other way than most corners of the grid do. Flat ones are not.
Result<void> CurvilinearGeometry::find_handedness() {
  std::int64_t right = 0, left = 0, has_right = 0, has_left = 0, cells = 0;
  for (std::int32_t i = 0; i + 1 < shape_.inlines; ++i) {
    for (std::int32_t j = 0; j + 1 < shape_.crosslines; ++j) {
      for (std::int32_t k = 0; k + 1 < shape_.samples; ++k, ++cells) {
        int turned_right = 0, turned_left = 0;
        for (int corner = 0; corner < 8; ++corner) {
          const double turn = turn_of(i, j, k, corner);
          turned_right += turn > 0;
          turned_left += turn < 0;
        }
        right += turned_right;
        left += turned_left;
        has_right += turned_right > 0;
        has_left += turned_left > 0;
      }
    }
  }
  mirrored_ = left > right;
  folded_share_ = static_cast<double>(mirrored_ ? has_right : has_left) / static_cast<double>(cells);
  if (folded_share_ <= kMostFolded) return {};
  char text[80];
  std::snprintf(text, sizeof text, "%.1f %% of the cells are folded; at most %.0f %%", 100 * folded_share_,
                100 * kMostFolded);
  return malformed(text);
}

}  // namespace geosis
