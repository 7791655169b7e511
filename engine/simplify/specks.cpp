#include "engine/simplify/specks.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace geosis {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

std::vector<std::uint8_t> vertices_on_boundaries(const IndexedMesh& m0) {
  const auto table = build_corner_table(m0);
  std::vector<std::uint8_t> on_boundary(m0.positions.size(), 0);
  if (!table) return on_boundary;  // refused later, with a reason
  for (std::int32_t c = 0; c < table->corners(); ++c) {
    if (table->opposite[c] == CornerTable::kNoCorner) on_boundary[table->vertex[CornerTable::next(c)]] = 1;
  }
  return on_boundary;
}

}  // namespace

Specks::Specks(const IndexedMesh& m0) : components_(find_components(m0)) {
  sizes_.assign(components_.count, {0, {kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}});
  dropped_.assign(components_.count, 0);
  const std::vector<std::uint8_t> on_boundary = vertices_on_boundaries(m0);
  for (std::size_t v = 0; v < m0.positions.size(); ++v) {
    if (components_.of_vertex[v] == Components::kUnused) continue;
    Size& size = sizes_[components_.of_vertex[v]];
    for (int axis = 0; axis < 3; ++axis) {
      size.low[axis] = std::min(size.low[axis], m0.positions[v][axis]);
      size.high[axis] = std::max(size.high[axis], m0.positions[v][axis]);
    }
    size.is_closed = size.is_closed && !on_boundary[v];
  }
  for (const auto& [a, b, c] : m0.triangles) {
    Size& size = sizes_[components_.of_vertex[a]];
    const Vec3d from = to_double(size.low);
    const auto corner = [&](std::int32_t v) { return to_double(m0.positions[v]) - from; };
    size.volume += dot(corner(a), cross(corner(b), corner(c)));
  }
}

bool Specks::drop(const DropSpecks& limits) {
  const std::int64_t before = dropped_count_;
  const auto largest = std::ranges::max_element(sizes_, {}, [](const Size& size) { return std::abs(size.volume); });
  for (std::size_t i = 0; i < sizes_.size(); ++i) {
    const Size& size = sizes_[i];
    if (dropped_[i] || !size.is_closed || &size == &*largest) continue;
    const bool small_volume = limits.max_voxels > 0 && std::abs(size.volume) / 6 <= limits.max_voxels;
    const bool small_extent = limits.max_error > 0 && norm(to_double(size.high - size.low)) / 2 <= limits.max_error;
    dropped_[i] = small_volume || small_extent;
    dropped_count_ += dropped_[i];
  }
  return dropped_count_ > before;
}

}  // namespace geosis
