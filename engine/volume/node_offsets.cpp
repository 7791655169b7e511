#include "engine/volume/node_offsets.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "engine/volume/node_report.h"

namespace geosis {
namespace {

bool is_finite(Vec3d p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}
bool is_finite(Vec3f p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

std::string text_of(Vec3d p) {
  char text[120];
  std::snprintf(text, sizeof text, "(%.10g, %.10g, %.10g)", p.x, p.y, p.z);
  return text;
}

/// Without a negative zero, which would give equal positions other bits.
Vec3d plain(Vec3d p) {
  return {p.x + 0.0, p.y + 0.0, p.z + 0.0};
}

}  // namespace

Result<NodeOffsets> NodeOffsets::begin(GridShape shape) {
  if (std::min({shape.inlines, shape.crosslines, shape.samples}) >= 2) return NodeOffsets(shape);
  return bad_positions("an axis has less than two nodes");
}

Result<void> NodeOffsets::add(std::span<const Vec3d> nodes, std::vector<Vec3f>& offsets) {
  if (nodes.size() > static_cast<std::size_t>(shape_.count()) - count_) {
    return bad_positions("more than the " + std::to_string(shape_.count()) + " nodes that the volume has");
  }
  for (const Vec3d& node : nodes) {
    if (!is_finite(node)) return bad_positions(name_of_node(shape_, count_) + " is " + text_of(node) + ": not finite");
    if (count_ == 0) origin_ = plain(node);
    const Vec3d way = plain(node - origin_);
    const Vec3f offset = {static_cast<float>(way.x), static_cast<float>(way.y), static_cast<float>(way.z)};
    if (!is_finite(offset)) {
      return bad_positions(name_of_node(shape_, count_) + " is " + text_of(node) + ": too far from the first node");
    }
    for (int axis = 0; axis < 3; ++axis) {
      low_[axis] = std::min(low_[axis], node[axis]);
      high_[axis] = std::max(high_[axis], node[axis]);
    }
    offsets.push_back(offset);
    ++count_;
  }
  return {};
}

Result<void> NodeOffsets::end() const {
  if (count_ == static_cast<std::size_t>(shape_.count())) return {};
  return bad_positions(std::to_string(count_) + "; the volume has " + std::to_string(shape_.count()) + " nodes");
}

Result<void> check_pillar(GridShape shape, std::size_t trace, const Pillar& pillar) {
  const auto crosslines = static_cast<std::size_t>(shape.crosslines);
  const std::string name =
      "the pillar of trace [" + std::to_string(trace / crosslines) + "," + std::to_string(trace % crosslines) + "]";
  if (!is_finite(pillar.top) || !is_finite(pillar.bottom)) {
    return bad_positions(name + " goes from " + text_of(pillar.top) + " to " + text_of(pillar.bottom) + ": not finite");
  }
  if (pillar.top.z == pillar.bottom.z) return bad_positions(name + " has both ends at one depth");
  return {};
}

}  // namespace geosis
