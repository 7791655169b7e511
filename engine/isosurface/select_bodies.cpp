#include "engine/isosurface/select_bodies.h"

#include <vector>

namespace geosis {
namespace {

constexpr std::int64_t kRemoved = -1;

/// Body -> its new number.
std::vector<std::int64_t> number_kept(const LabelledSurface& surface, const BodyFilter& filter) {
  const std::size_t bodies = surface.samples.size();
  std::vector<bool> is_seeded(bodies, !filter.seeded);
  for (const auto& body : surface.seed_body) {
    if (body) is_seeded[*body] = true;
  }
  std::vector<std::int64_t> number(bodies, kRemoved);
  std::int64_t kept = 0;
  for (std::size_t body = 0; body < bodies; ++body) {  // largest first
    if (filter.largest && kept == *filter.largest) break;
    // Without a bound a body too thin for its flat triangles, which may enclose less than nothing, stays.
    if (!is_seeded[body] || (filter.min_voxels > 0 && surface.volume_voxels[body] < filter.min_voxels)) continue;
    number[body] = kept++;
  }
  return number;
}

template <class T>
void keep_bodies(std::vector<T>& of_body, const std::vector<std::int64_t>& number) {
  std::size_t kept = 0;
  for (std::size_t body = 0; body < number.size(); ++body) {
    if (number[body] != kRemoved) of_body[kept++] = of_body[body];
  }
  of_body.resize(kept);
}

/// Vertices of the bodies that stay, closed up; returns vertex -> its new index.
std::vector<std::int32_t> keep_vertices(LabelledSurface& surface, const std::vector<std::int64_t>& number) {
  std::vector<std::int32_t> index(surface.body.size(), static_cast<std::int32_t>(kRemoved));
  std::int32_t kept = 0;
  for (std::size_t v = 0; v < surface.body.size(); ++v) {
    const std::int64_t body = number[surface.body[v]];
    if (body == kRemoved) continue;
    surface.mesh.positions[kept] = surface.mesh.positions[v];
    surface.body[kept] = static_cast<std::uint32_t>(body);
    index[v] = kept++;
  }
  surface.mesh.positions.resize(static_cast<std::size_t>(kept));
  surface.body.resize(static_cast<std::size_t>(kept));
  return index;
}

void keep_triangles(std::vector<Triangle>& triangles, const std::vector<std::int32_t>& index) {
  std::size_t kept = 0;
  for (const auto& [p, q, r] : triangles) {
    if (index[p] != kRemoved) triangles[kept++] = {index[p], index[q], index[r]};
  }
  triangles.resize(kept);
}

}  // namespace

void select_bodies(LabelledSurface& surface, const BodyFilter& filter) {
  const std::vector<std::int64_t> number = number_kept(surface, filter);
  bool all = true;
  for (const std::int64_t n : number) all = all && n != kRemoved;
  if (all) return;
  const std::vector<std::int32_t> index = keep_vertices(surface, number);
  keep_triangles(surface.mesh.triangles, index);
  keep_bodies(surface.samples, number);
  keep_bodies(surface.volume_voxels, number);
  for (auto& body : surface.seed_body) {
    if (!body) continue;
    const std::int64_t kept = number[*body];
    body = kept == kRemoved ? std::nullopt : std::optional(static_cast<std::uint32_t>(kept));
  }
}

}  // namespace geosis
