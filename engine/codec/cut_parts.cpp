#include "engine/codec/cut_parts.h"

#include <algorithm>
#include <limits>
#include <span>

#include "engine/codec/attribute_arrays.h"

namespace geosis {
namespace {

std::span<const Triangle> triangles_of(const IndexedMesh& mesh, const PartPlan& plan, std::size_t part) {
  const std::size_t first = plan.first_triangle[part];
  return std::span(mesh.triangles).subspan(first, plan.first_triangle[part + 1] - first);
}

std::vector<bool> find_shared_vertices(const IndexedMesh& mesh, const PartPlan& plan) {
  constexpr std::uint32_t kUnused = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> first_part(mesh.positions.size(), kUnused);
  std::vector<bool> shared(mesh.positions.size(), false);
  for (std::uint32_t part = 0; part < plan.parts(); ++part) {
    for (const Triangle& triangle : triangles_of(mesh, plan, part)) {
      for (const std::int32_t v : triangle) {
        if (first_part[v] == kUnused) first_part[v] = part;
        if (first_part[v] != part) shared[v] = true;
      }
    }
  }
  return shared;
}

std::vector<std::uint32_t> number_seams(const std::vector<bool>& shared) {
  std::vector<std::uint32_t> seams(shared.size(), 0);
  std::uint32_t next = 1;
  for (std::size_t v = 0; v < shared.size(); ++v) {
    if (shared[v]) seams[v] = next++;
  }
  return seams;
}

/// The values of the vertices `used`, for each array that there is.
VertexAttributes pick_attributes(const VertexAttributes& attributes, const std::vector<std::int32_t>& used) {
  VertexAttributes picked;
  for_each_array([&](const char*, auto array) {
    if ((attributes.*array).empty()) return;
    (picked.*array).reserve(used.size());
    for (const std::int32_t v : used) (picked.*array).push_back((attributes.*array)[v]);
  });
  return picked;
}

}  // namespace

PartPlan plan_parts(const IndexedMesh& mesh, std::int32_t max_part_triangles) {
  const std::size_t triangles = mesh.triangles.size();
  const auto limit = static_cast<std::size_t>(max_part_triangles);
  const std::size_t parts = std::max<std::size_t>(1, (triangles + limit - 1) / limit);
  const std::size_t size = triangles / parts, larger_parts = triangles % parts;
  PartPlan plan;
  for (std::size_t part = 0; part <= parts; ++part) {
    plan.first_triangle.push_back(part * size + std::min(part, larger_parts));
  }
  if (parts > 1) plan.seams = number_seams(find_shared_vertices(mesh, plan));
  return plan;
}

MeshPart cut_part(const IndexedMesh& mesh, const VertexAttributes& attributes, const PartPlan& plan, std::size_t part) {
  const std::span<const Triangle> triangles = triangles_of(mesh, plan, part);
  std::int32_t lowest = std::numeric_limits<std::int32_t>::max(), highest = 0;
  for (const auto& [a, b, c] : triangles) {
    lowest = std::min({lowest, a, b, c});
    highest = std::max({highest, a, b, c});
  }
  constexpr std::int32_t kUnused = -1;
  std::vector<std::int32_t> local(static_cast<std::size_t>(highest - lowest) + 1, kUnused);
  for (const Triangle& triangle : triangles) {
    for (const std::int32_t v : triangle) local[v - lowest] = 0;
  }

  MeshPart result;
  std::vector<std::int32_t> used;
  for (std::int32_t v = lowest; v <= highest; ++v) {
    if (local[v - lowest] == kUnused) continue;
    local[v - lowest] = static_cast<std::int32_t>(used.size());
    used.push_back(v);
    result.mesh.positions.push_back(mesh.positions[v]);
    if (!plan.seams.empty()) result.seams.push_back(plan.seams[v]);
  }
  result.attributes = pick_attributes(attributes, used);
  result.mesh.triangles.reserve(triangles.size());
  for (const auto& [a, b, c] : triangles) {
    result.mesh.triangles.push_back({local[a - lowest], local[b - lowest], local[c - lowest]});
  }
  return result;
}

}  // namespace geosis
