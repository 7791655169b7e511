#include "engine/simplify/check_m0.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "engine/mesh/check.h"
#include "engine/mesh/corner_table.h"
#include "engine/simplify/chunks.h"

namespace geosis {
namespace {

constexpr float kLargestCoordinate = 131'072;  // voxels; beyond, float32 does not hold all lattice points

bool on_lattice(float x) {
  const bool in_range = std::abs(x) <= kLargestCoordinate;  // false for NaN
  const float steps = in_range ? x * kLatticeStepsPerVoxel : 0.5f;
  return steps == static_cast<float>(static_cast<std::int32_t>(steps));
}

Error off_lattice(std::size_t v, Vec3f position) {
  int axis = 0;
  while (on_lattice(position[axis])) ++axis;
  return {ErrorCode::invalid_argument, "vertex " + std::to_string(v) + ": coordinate " +
                                           std::to_string(position[axis]) +
                                           "; expected a multiple of 1/64 within 131072 of zero"};
}

Result<void> check_positions(const std::vector<Vec3f>& positions, int threads) {
  std::array<std::size_t, kChunks> first_off;  // of each chunk; the end = none
  for_chunks(positions.size(), threads, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
    const auto off = [](Vec3f p) { return !on_lattice(p.x) || !on_lattice(p.y) || !on_lattice(p.z); };
    const auto found = std::find_if(positions.begin() + static_cast<std::ptrdiff_t>(begin),
                                    positions.begin() + static_cast<std::ptrdiff_t>(end), off);
    const auto v = static_cast<std::size_t>(found - positions.begin());
    first_off[chunk] = v < end ? v : positions.size();
  });
  const std::size_t first = *std::min_element(first_off.begin(), first_off.end());
  if (first < positions.size()) return off_lattice(first, positions[first]);
  return {};
}

bool indices_in_range(const IndexedMesh& mesh, int threads) {
  const auto vertices = static_cast<std::uint32_t>(mesh.positions.size());
  std::atomic<bool> in_range = mesh.positions.size() <= std::numeric_limits<std::int32_t>::max();
  for_chunks(mesh.triangles.size(), threads, [&](std::size_t, std::size_t begin, std::size_t end) {
    bool all = true;
    for (std::size_t t = begin; t < end; ++t) {
      for (const std::int32_t v : mesh.triangles[t]) all &= static_cast<std::uint32_t>(v) < vertices;
    }
    if (!all) in_range = false;
  });
  return in_range;
}

}  // namespace

Result<void> check_m0(const IndexedMesh& m0, int threads) {
  if (auto lattice = check_positions(m0.positions, threads); !lattice) return lattice;
  if (!indices_in_range(m0, threads)) return fault_of(m0);
  return {};
}

Error fault_of(const IndexedMesh& m0) {
  const auto table = build_corner_table(m0);
  if (!table) return table.error();
  if (auto fans = check_fans(*table, m0.positions.size()); !fans) return std::move(fans).error();
  return {ErrorCode::internal, "levels of detail: a manifold was taken for something else"};
}

}  // namespace geosis
