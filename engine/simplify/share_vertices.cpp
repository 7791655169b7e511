#include "engine/simplify/share_vertices.h"

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <vector>

namespace geosis {
namespace {

void fill_origin(LodLevel& level) {
  if (!level.origin.empty()) return;
  level.origin.resize(level.mesh.positions.size());
  std::iota(level.origin.begin(), level.origin.end(), 0);
}

/// New number of each vertex of M0: those of the coarsest level first, then what the next finer one adds, ...
std::vector<std::int32_t> numbers_by_level(const LodHierarchy& hierarchy, std::size_t m0_vertices) {
  std::vector<const LodLevel*> coarsest_first;
  for (auto level = hierarchy.levels.rbegin(); level != hierarchy.levels.rend(); ++level) {
    coarsest_first.push_back(&*level);
  }
  std::ranges::stable_sort(coarsest_first, {}, [](const LodLevel* level) { return level->origin.size(); });
  std::vector<std::int32_t> number(m0_vertices, -1);
  std::int32_t next = 0;
  for (const LodLevel* level : coarsest_first) {
    for (const std::int32_t v : level->origin) {
      if (number[v] < 0) number[v] = next++;
    }
  }
  return number;
}

void renumber(LodLevel& level, const std::vector<std::int32_t>& number) {
  std::vector<Vec3f> positions(level.mesh.positions.size());
  std::vector<std::int32_t> origin(level.origin.size());
  for (std::size_t v = 0; v < origin.size(); ++v) {
    positions[number[level.origin[v]]] = level.mesh.positions[v];
    origin[number[level.origin[v]]] = level.origin[v];
  }
  for (Triangle& triangle : level.mesh.triangles) {
    for (std::int32_t& v : triangle) v = number[level.origin[v]];
  }
  level.mesh.positions = std::move(positions);
  level.origin = std::move(origin);
}

}  // namespace

void share_vertices(LodHierarchy& hierarchy, std::size_t m0_vertices) {
  for (LodLevel& level : hierarchy.levels) fill_origin(level);
  const std::vector<std::int32_t> number = numbers_by_level(hierarchy, m0_vertices);
  for (LodLevel& level : hierarchy.levels) renumber(level, number);
}

}  // namespace geosis
